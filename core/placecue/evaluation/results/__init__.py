"""What methods said of test recordings, kept in a folder, and tables over them."""
