"""Why a transform can't be had. The names are those of tf2."""


class TransformException(Exception):
    """The base of all of tf2's exceptions."""


class LookupException(TransformException):
    """A frame is not known, because no transform with it has arrived."""


class ConnectivityException(TransformException):
    """Both frames are known, but no chain of transforms joins them."""


class ExtrapolationException(TransformException):
    """The chain is known, but not at the time that was asked for."""


class InvalidArgumentException(TransformException):
    """A frame's name is empty or begins with a slash, or a rotation is not a unit quaternion."""


class TimeoutException(TransformException):
    """The transform did not come within the time limit."""
