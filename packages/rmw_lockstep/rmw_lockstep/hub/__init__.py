"""The hub's side of the protocol: see PROTOCOL.md."""

from rmw_lockstep.hub.endpoints import (
    DeliveredMessage,
    HubClient,
    HubNode,
    HubPublisher,
    HubServer,
    HubSubscription,
    Moment,
    PendingRequest,
)
from rmw_lockstep.hub.frames import CLIENT, PUBLISHER, SERVER, SUBSCRIPTION, EndpointFrame, NodeFrame
from rmw_lockstep.hub.hub import BEGIN, SOCKET, TICK_S, Hub
from rmw_lockstep.hub.limits import HubLimits, Violation
from rmw_lockstep.hub.router import EPOCH
from rmw_lockstep.qos import QosPolicies

__all__ = [
    "BEGIN",
    "CLIENT",
    "EPOCH",
    "PUBLISHER",
    "SERVER",
    "SOCKET",
    "SUBSCRIPTION",
    "TICK_S",
    "DeliveredMessage",
    "EndpointFrame",
    "Hub",
    "HubClient",
    "HubLimits",
    "HubNode",
    "HubPublisher",
    "HubServer",
    "HubSubscription",
    "Moment",
    "NodeFrame",
    "PendingRequest",
    "QosPolicies",
    "Violation",
]
