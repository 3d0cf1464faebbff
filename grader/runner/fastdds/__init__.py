"""The second opinion: the same run over Fast DDS, where the grader has to infer when a node is done."""
