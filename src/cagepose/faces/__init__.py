"""What people look at: pictures and the report of the paper's cases. matplotlib, an extra, is used nowhere else."""
