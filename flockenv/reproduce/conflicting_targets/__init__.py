"""Leaders with opposite targets: which side a flock follows, how soon, and whether it stalls."""
