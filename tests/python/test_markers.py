"""debug/markers (W-14, B-17, J-17), as RViz subscribes them."""

import json
import math
import subprocess

import numpy
import pytest
from conftest import BINARY, HERE, STREAM, wait_until
from sensor_msgs.msg import JointState
from tf2_like import Frames
from visualization_msgs.msg import Marker, MarkerArray

ORIGIN = HERE / "../../urdf/origin.urdf"
KINDS = ["wireframes", "aabbs", "contacts", "axes", "ranges", "centers_of_mass", "principal_axes",
         "link_centers_of_mass", "link_principal_axes"]
ON_THE_GROUND = ["-p", f"scene:={HERE / '../../config/on_the_ground.yaml'}", "-p", "markers_rate:=50.0"]


class Scene:
    """What RViz would show after a list of messages."""

    def __init__(self, messages):
        self.messages = messages

    def markers(self):
        shown = {}
        for message in list(self.messages):
            for m in message.markers:
                if m.action == Marker.DELETEALL:
                    shown.clear()
                elif m.action == Marker.DELETE:
                    shown.pop((m.ns, m.id), None)
                else:
                    shown[m.ns, m.id] = m
        return shown

    def kinds(self):
        return {ns for ns, _ in self.markers()}

    def of(self, ns):
        return {key[1]: m for key, m in self.markers().items() if key[0] == ns}


@pytest.fixture
def standing(start):
    """The humanoid, free on the ground."""
    bench = start(*ON_THE_GROUND, urdf=None)
    return bench, Scene(bench.probe.listen(MarkerArray, "debug/markers"))


def inspected():
    return json.loads(subprocess.check_output([BINARY, "inspect", ORIGIN, "--ground", "--json"]))


def points(marker):
    """Points of a marker in its header's frame."""
    return numpy.array([Frames.apply(marker.pose, p) for p in marker.points])


def marker_count(bench):
    return bench.count(": node", "marker messages")


def test_every_kind_is_shown_for_the_humanoid_on_the_ground(standing):
    bench, scene = standing
    wait_until(lambda: scene.kinds() >= set(KINDS), what="every kind")
    assert scene.kinds() == set(KINDS), "no normals unless they are asked for"
    facts = inspected()
    markers = scene.markers()
    colliders = facts["world"]["colliders"]
    assert len(scene.of("wireframes")) == len(colliders)
    # The half-space of the ground has no box around it.
    assert len(scene.of("aabbs")) == len(colliders) - 1
    assert len(scene.of("axes")) == len(facts["axes"]) and len(scene.of("ranges")) == 2 * len(facts["axes"])
    links = {link["name"] for link in facts["links"]} | {"world"}
    for m in markers.values():
        assert m.header.frame_id in links and (m.header.stamp.sec, m.header.stamp.nanosec) == (0, 0)
        assert m.frame_locked and m.lifetime.sec == m.lifetime.nanosec == 0
        assert min(m.scale.x, m.scale.y, m.scale.z) >= 0 and m.scale.x > 0
        assert abs(sum(getattr(m.pose.orientation, c) ** 2 for c in "xyzw") - 1.0) < 1e-9
        assert 0 < m.color.a <= 1
        if m.type == Marker.LINE_LIST:
            assert len(m.points) >= 2 and len(m.points) % 2 == 0 and len(m.colors) in (0, len(m.points))
        else:
            assert m.type in (Marker.SPHERE, Marker.SPHERE_LIST) and m.scale.x == m.scale.y == m.scale.z


def test_centres_of_mass_and_principal_axes_are_those_of_inspect(standing):
    bench, scene = standing
    wanted = {"centers_of_mass", "principal_axes", "link_centers_of_mass", "link_principal_axes"}
    wait_until(lambda: scene.kinds() >= wanted, what="centres and axes")
    facts = inspected()
    centers, axes = scene.of("centers_of_mass"), scene.of("principal_axes")
    heavy = {i: link for i, link in enumerate(facts["links"]) if link["mass"] > 0}
    assert set(centers) == set(axes) == set(heavy)
    for i, link in heavy.items():
        p = centers[i].pose.position
        assert centers[i].header.frame_id == link["name"]
        assert [p.x, p.y, p.z] == pytest.approx(link["center_of_mass"], abs=1e-9)
        assert centers[i].scale.x == pytest.approx(2 * 0.005)
        lines = points(axes[i]).reshape(3, 2, 3)
        moments = link["principal_moments"]
        for k, (start, end) in enumerate(lines):
            assert start == pytest.approx(link["center_of_mass"], abs=1e-9)
            assert numpy.linalg.norm(end - start) == pytest.approx(40 * 0.005)
            if moments[k] not in moments[:k] + moments[k + 1 :]:
                turn = abs((end - start) @ numpy.array(link["principal_axes"][k])) / 0.2
                assert turn == pytest.approx(1.0, abs=1e-6), (link["name"], k)
    joint_links = {link["frame"]: link for link in facts["joint_links"]}
    shown = {m.header.frame_id: m for m in scene.of("link_centers_of_mass").values()}
    assert set(shown) == set(joint_links)
    for frame, m in shown.items():
        p = m.pose.position
        assert [p.x, p.y, p.z] == pytest.approx(joint_links[frame]["center_of_mass"], abs=1e-9)
    lengths = [numpy.linalg.norm(points(m)[1] - points(m)[0]) for m in scene.of("link_principal_axes").values()]
    assert lengths == pytest.approx([20 * 0.005] * len(joint_links))


def test_contacts_carry_the_weight_and_boxes_hold_the_wireframes(standing):
    bench, scene = standing
    frames = Frames(bench.probe)
    wait_until(lambda: len(scene.of("contacts")) == 3 and frames.complete(), what="contacts")
    mass = inspected()["mass"]

    def carried():
        """What is shown at the first instant at which the ground carries the humanoid."""
        shown = scene.markers()
        forces = shown.get(("contacts", 2))
        if forces is None:
            return None
        lines = points(forces).reshape(-1, 2, 3)
        total = sum(end - start for start, end in lines) / 0.001
        return shown if abs(abs(total[2]) - mass * 9.80665) < 0.02 * mass * 9.80665 else None

    shown = wait_until(carried, what="the ground to carry the humanoid")
    frames.take()
    at, normals = points(shown["contacts", 0]), points(shown["contacts", 1]).reshape(-1, 2, 3)
    assert abs(at[:, 2]).max() < 0.005 and len(at) == len(normals)
    assert numpy.linalg.norm(normals[:, 1] - normals[:, 0], axis=1) == pytest.approx(0.05)
    # It stands still: tf and markers of slightly different instants may be compared.
    for i, box in ((i, box) for (kind, i), box in shown.items() if kind == "aabbs"):
        low, high = points(box).min(axis=0), points(box).max(axis=0)
        wire = shown["wireframes", i]
        edges = numpy.array([frames.in_world(wire.header.frame_id, p) for p in points(wire)])
        assert (edges > low - 2e-3).all() and (edges < high + 2e-3).all(), i
        # Polygons of 16 segments lie up to 2 % of a radius inside; the box is that of the true shape.
        assert (edges.min(axis=0) < low + 0.01).all() and (edges.max(axis=0) > high - 0.01).all(), i


def test_ranges_turn_about_their_axes_from_end_to_end(start):
    """The hand, in the frame of the link that is carried, stands at the present angle of the arc, in that of the parent."""
    bench = start("-p", "markers:=[axes, ranges]", "-p", "markers_rate:=50.0")
    scene, frames = Scene(bench.probe.listen(MarkerArray, "debug/markers")), Frames(bench.probe)
    wait_until(lambda: len(scene.of("ranges")) == 6 and frames.complete(), what="ranges")
    assert scene.kinds() == {"axes", "ranges"}
    # One publisher: of two, the second may be heard first.
    command = bench.probe.publisher(JointState, "joint_command")
    for target in (0.0, 0.7):
        command.publish(JointState(name=["hip"], position=[target]))
        wait_until(lambda: abs(bench.axis("hip")[0] - target) < 1e-3, what="the hip")
        ranges = scene.of("ranges")
        arc, hand = ranges[0], ranges[1]
        assert (arc.header.frame_id, hand.header.frame_id) == ("base", "thigh")
        wait_until(lambda: frames.turn("thigh") == pytest.approx(target, abs=2e-3), what="tf")
        ends = points(arc).reshape(-1, 2, 3)
        origin = numpy.array([0.0, 0.0, 1.0])
        zero = frames.vector("thigh", points(hand)[1] - points(hand)[0])
        angle = lambda v: math.atan2(v[1], v[0])
        from_lower = lambda v: (angle(v) - angle(ends[-2][1] - origin)) % (2 * math.pi)
        # The hip goes from -2 to 2 rad.
        assert from_lower(zero) == pytest.approx(target + 2.0, abs=5e-3)
        assert from_lower(ends[-1][1] - origin) == pytest.approx(4.0, abs=1e-9)
        assert numpy.linalg.norm(ends[-1][1] - origin) == pytest.approx(0.1)
    for axis in scene.of("axes").values():
        assert abs(points(axis)[1] - points(axis)[0]) == pytest.approx([0, 0, 0.2])


def test_nothing_is_made_before_somebody_subscribes_and_all_is_taken_back(start):
    bench = start(*ON_THE_GROUND, urdf=None)
    wait_until(lambda: len(bench.diagnostics) > 2 and marker_count(bench) == "0", what="diagnostics")
    messages = []
    subscription = bench.probe.node.create_subscription(MarkerArray, "debug/markers", messages.append, STREAM)
    bench.probe.executor.wake()
    wait_until(lambda: messages and int(marker_count(bench)) > 0, what="markers")
    assert messages[0].markers[0].action == Marker.DELETEALL or len(messages[0].markers) > 50
    client = bench.probe.parameters()
    assert bench.probe.set(client, markers_rate=0.0)[0].successful
    scene = Scene(messages)
    wait_until(lambda: not scene.markers(), what="a DELETEALL")
    assert messages[-1].markers[0].action == Marker.DELETEALL
    assert bench.probe.set(client, markers_rate=50.0)[0].successful
    wait_until(lambda: scene.of("wireframes"), what="markers again")
    bench.probe.node.destroy_subscription(subscription)
    wait_until(lambda: bench.count(": node", "subscribers of /debug/markers") == "0", what="nobody")
    before = wait_until(lambda: marker_count(bench))
    seen = len(bench.diagnostics)
    wait_until(lambda: len(bench.diagnostics) >= seen + 2, what="two more seconds")
    assert int(marker_count(bench)) <= int(before) + 1


def test_a_second_subscriber_gets_what_does_not_change_too(standing):
    bench, scene = standing
    wait_until(lambda: scene.of("wireframes"), what="the first subscriber")
    late = Scene(bench.probe.listen(MarkerArray, "debug/markers"))
    wait_until(lambda: late.of("wireframes") and late.of("axes"), what="the second subscriber")


def test_kinds_size_and_colour_are_parameters_with_good_and_bad_values(standing):
    bench, scene = standing
    client = bench.probe.parameters()
    wait_until(lambda: scene.of("wireframes"), what="markers")
    for name, value, reason in [
        ("markers", ["wireframes", "shadows"], "shadows"),
        ("markers_rate", -1.0, "0.0 … 1000.0"),
        ("markers_size", 2.0, "0.0 … 1.0"),
        ("markers_color", [1.0, 0.0, 0.0], "4 numbers"),
        ("markers_color", [1.0, 0.0, 0.0, 1.5], "0.0 … 1.0"),
    ]:
        before = bench.probe.get(client, name)
        [result] = bench.probe.set(client, **{name: value})
        assert not result.successful and reason in result.reason and name in result.reason
        assert bench.probe.get(client, name) == before
    good = {"markers": ["centers_of_mass", "normals"], "markers_size": 0.0, "markers_color": [0.0, 1.0, 0.0, 0.5]}
    assert all(result.successful for result in bench.probe.set(client, **good))
    # One parameter is set after the other, and there are markers of in between.
    of = lambda color: (color.r, color.g, color.b, color.a)
    colors = lambda: {of(m.color) for m in scene.of("centers_of_mass").values()}
    wanted = lambda: scene.kinds() == {"centers_of_mass", "normals"} and colors() == {(0.0, 1.0, 0.0, 0.5)}
    wait_until(wanted, what="the kinds and the colour asked for")
    facts = inspected()
    # B-17: size 0 is the least half edge of the box around the shapes: of a ball its radius.
    colliders = [c for c in facts["world"]["colliders"] if c["link"]]
    lone = next(c for c in colliders if c["form"] == "ball" and sum(d["link"] == c["link"] for d in colliders) == 1)
    index = next(i for i, link in enumerate(facts["links"]) if link["name"] == lone["link"])
    ball = scene.of("centers_of_mass")[index]
    normal = [m for m in scene.of("normals").values() if m.header.frame_id == lone["link"]][0]
    starts = numpy.array([[p.x, p.y, p.z] for p in normal.points])[0::2]
    assert ball.scale.x / 2 == pytest.approx(numpy.linalg.norm(starts, axis=1).max(), rel=0.05)


@pytest.mark.parametrize("engine", ["rapier", "bullet"])
def test_other_engines_show_the_same(start, engine):
    bench = start(*ON_THE_GROUND, "-p", f"engine:={engine}", urdf=None)
    scene = Scene(bench.probe.listen(MarkerArray, "debug/markers"))
    wait_until(lambda: scene.kinds() == set(KINDS), what="every kind")


def test_leaving_takes_the_markers_away(standing):
    bench, scene = standing
    wait_until(lambda: scene.of("wireframes"), what="markers")
    bench.simulator.stop()
    wait_until(lambda: not scene.markers(), what="the last message")
