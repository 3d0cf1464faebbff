"""The second opinion: the same run over Fast DDS, where it has to be inferred when a node is done."""
