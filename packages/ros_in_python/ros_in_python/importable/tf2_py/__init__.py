"""tf2's tree of coordinate frames, without ROS communication: which frame is where in another, and when."""

from tf2_py.buffer_core import BufferCore as BufferCore
from tf2_py.exceptions import ConnectivityException as ConnectivityException
from tf2_py.exceptions import ExtrapolationException as ExtrapolationException
from tf2_py.exceptions import InvalidArgumentException as InvalidArgumentException
from tf2_py.exceptions import LookupException as LookupException
from tf2_py.exceptions import TimeoutException as TimeoutException
from tf2_py.exceptions import TransformException as TransformException
