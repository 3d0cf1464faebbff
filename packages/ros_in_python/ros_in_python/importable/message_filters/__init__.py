"""Brings messages of several topics together that belong together by their time stamps."""

from message_filters.filters import Cache as Cache
from message_filters.filters import SimpleFilter as SimpleFilter
from message_filters.filters import Subscriber as Subscriber
from message_filters.synchronizers import ApproximateTimeSynchronizer as ApproximateTimeSynchronizer
from message_filters.synchronizers import TimeSynchronizer as TimeSynchronizer
