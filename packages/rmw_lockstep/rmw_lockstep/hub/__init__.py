"""The hub's end of the protocol between programs and the hub: see PROTOCOL.md."""

from rmw_lockstep.hub.ends import Asked, Client, Heard, HubNode, Moment, Publisher, Server, Subscription
from rmw_lockstep.hub.frames import CLIENT, PUBLISHER, SERVER, SUBSCRIPTION, EndPoint, Node
from rmw_lockstep.hub.hub import BEGIN, EPOCH, SOCKET, TICK_S, Hub
from rmw_lockstep.hub.limits import Limits, Violation
from rmw_lockstep.qos import Qos

__all__ = [
    "BEGIN",
    "CLIENT",
    "EPOCH",
    "PUBLISHER",
    "SERVER",
    "SOCKET",
    "SUBSCRIPTION",
    "TICK_S",
    "Asked",
    "Client",
    "EndPoint",
    "Heard",
    "Hub",
    "HubNode",
    "Limits",
    "Moment",
    "Node",
    "Publisher",
    "Qos",
    "Server",
    "Subscription",
    "Violation",
]
