"""A robot by its URDF: where its links are for given joint positions, and the nodes that publish that."""
