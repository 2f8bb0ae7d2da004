"""What ``placecue doctor`` looks at, one small file each."""
