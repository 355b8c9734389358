// Readers of mesh files.
