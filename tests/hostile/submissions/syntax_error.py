"""Python cannot read it."""


class JointVelocity(Node:
    pass
