"""Clients of services, by the names and types alone."""

import re

from realnoid.srv import Record, SetJointAngles
from simulation_interfaces.msg import SimulationState
from simulation_interfaces.srv import DeleteEntity, ResetSimulation, SetEntityState, SetSimulationState, StepSimulation

# A reply to the first request of a client may get lost, because the two have not found each other yet. Where it matters that a request
# is not sent twice, one that is refused goes first.
REFUSED = {
    StepSimulation: dict(steps=0),
    SetSimulationState: dict(state=SimulationState(state=77)),
    ResetSimulation: dict(scope=8),
    SetEntityState: dict(entity="nobody"),
    DeleteEntity: dict(entity="nobody"),
    SetJointAngles: dict(name=[]),
    Record: dict(start=True, folder="/"),
}


class Services:
    """Calls services of a bench: `services(Type, field=value)`; the name is the type's in snake case, unless it is given."""

    def __init__(self, bench, namespace=""):
        self.bench, self.namespace, self.clients = bench, namespace, {}

    def start(self, kind, service=None, **fields):
        """A function that sends the request, and returns the future."""
        service = self.namespace + (service or re.sub(r"(?<!^)(?=[A-Z])", "_", kind.__name__).lower())
        if service not in self.clients:
            client = self.clients[service] = self.bench.probe.node.create_client(kind, service)
            assert client.wait_for_service(30.0), service
            if kind in REFUSED:
                self.bench.probe.call(lambda: client.call_async(kind.Request(**REFUSED[kind])))
        return lambda: self.clients[service].call_async(kind.Request(**fields))

    def __call__(self, kind, service=None, timeout=30.0, **fields):
        return self.bench.probe.call(self.start(kind, service, **fields), timeout=timeout, twice=kind not in REFUSED)
