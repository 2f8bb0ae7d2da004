"""Where tasks run: processes, threads, a cluster; joblib is the only seam."""
