"""What is kept on disk: model folders and atomic writes."""
