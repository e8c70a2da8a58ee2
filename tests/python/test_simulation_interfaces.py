"""The standard simulation_interfaces (1.5), by a client that knows nothing but the standard."""

import math

import pytest
from conftest import ARM, nanoseconds, until_heard, wait_until
from cyclone import listen as cyclone_listen
from geometry_msgs.msg import Point, Pose, Quaternion, Twist, Vector3
from rcl_interfaces.msg import ParameterEvent
from realnoid.srv import SetJointAngles
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from services import Services
from simulation_interfaces.msg import (
    Bounds,
    EntityCategory,
    EntityFilters,
    EntityState,
    Result,
    SimulationState,
    SimulatorFeatures,
    TagsFilter,
)
from simulation_interfaces.srv import (
    GetEntities,
    GetEntitiesStates,
    GetEntityInfo,
    GetEntityState,
    GetSimulationState,
    GetSimulatorFeatures,
    ResetSimulation,
    SetEntityState,
    SetSimulationState,
    StepSimulation,
)
from std_msgs.msg import Header

OK, FAILED, UNSUPPORTED = Result.RESULT_OK, Result.RESULT_OPERATION_FAILED, Result.RESULT_FEATURE_UNSUPPORTED
PLAYING, PAUSED, STOPPED, QUITTING = (
    SimulationState.STATE_PLAYING,
    SimulationState.STATE_PAUSED,
    SimulationState.STATE_STOPPED,
    SimulationState.STATE_QUITTING,
)
MS = 1_000_000

SCENE = """
version: 1
robot: {base: free, pose: [0, 0, 1, 0, 0, 0, 1]}
bodies:
  - {name: ball, shape: {sphere: {radius: 0.1}}, mass: 1.0, pose: [1, 2, 3, 0, 0, 0, 1]}
  - {name: wall, shape: {box: {size: [1, 1, 1]}}, static: true, pose: [5, 0, 0.5, 0, 0, 0, 1]}
world: {gravity: [0, 0, 0]}
"""


HEAVY = """<link name="base"><inertial><mass value="5"/>
  <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>"""


def start_scene(start, folder, *arguments):
    """The arm on a free base, a ball and a wall, without weight, and time stands."""
    (folder / "scene.yaml").write_text(SCENE)
    (folder / "arm.urdf").write_text(ARM.read_text().replace('<link name="base"/>', HEAVY))
    arguments = ["-p", f"scene:={folder / 'scene.yaml'}", "-p", "start:=paused", *arguments]
    bench = start(*arguments, urdf=folder / "arm.urdf")
    return bench, Services(bench)


@pytest.fixture
def scene(start, tmp_path):
    return start_scene(start, tmp_path)


def state(services):
    return services(GetSimulationState).state.state


def go(services, wanted):
    return services(SetSimulationState, state=SimulationState(state=wanted)).result


def stamp(bench):
    return nanoseconds(bench.states[-1].header.stamp)


def pose_of(services, entity):
    answer = services(GetEntityState, entity=entity)
    assert answer.result.result == OK, answer.result.error_message
    p, q = answer.state.pose.position, answer.state.pose.orientation
    return [p.x, p.y, p.z, q.x, q.y, q.z, q.w]


def a_state(position=(0.0, 0.0, 0.0), quaternion=(0.0, 0.0, 0.0, 1.0), linear=(0.0,) * 3, angular=(0.0,) * 3, frame=""):
    vector = lambda v: Vector3(x=v[0], y=v[1], z=v[2])
    x, y, z = position
    qx, qy, qz, qw = quaternion
    return EntityState(
        header=Header(frame_id=frame),
        pose=Pose(position=Point(x=x, y=y, z=z), orientation=Quaternion(x=qx, y=qy, z=qz, w=qw)),
        twist=Twist(linear=vector(linear), angular=vector(angular)),
    )


def test_features_are_those_that_are_there(bench):
    features = Services(bench)(GetSimulatorFeatures).features
    F = SimulatorFeatures
    assert set(features.features) == {
        F.DELETING, F.ENTITY_CATEGORIES, F.ENTITY_STATE_GETTING, F.ENTITY_STATE_SETTING, F.ENTITY_INFO_GETTING,
        F.SIMULATION_RESET, F.SIMULATION_RESET_TIME, F.SIMULATION_RESET_STATE,
        F.SIMULATION_STATE_GETTING, F.SIMULATION_STATE_SETTING, F.SIMULATION_STATE_PAUSE,
        F.STEP_SIMULATION_SINGLE, F.STEP_SIMULATION_MULTIPLE,
    }
    assert not features.spawn_formats and "control interval" in features.custom_info


def test_pausing_and_playing_agree_with_the_parameter_and_are_announced(bench):
    services, client = Services(bench), bench.probe.parameters()
    events = bench.probe.listen(ParameterEvent, "/parameter_events")
    assert state(services) == PLAYING
    again = go(services, PLAYING)
    assert again.result == SetSimulationState.Response.ALREADY_IN_TARGET_STATE and "PLAYING already" in again.error_message
    assert go(services, PAUSED).result == OK
    assert state(services) == PAUSED and bench.probe.get(client, "paused") is True
    announced = lambda: [p.value.bool_value for e in events for p in e.changed_parameters if p.name == "paused"]

    def announce():  # what is announced before the subscription is matched reaches nobody
        assert go(services, PLAYING).result == OK and go(services, PAUSED).result == OK

    until_heard(announce, lambda: announced() and announced()[-1] is True, "the event")
    stands = nanoseconds(services(GetEntityState, entity="arm").state.header.stamp)
    wait_until(lambda: stamp(bench) == stands, what="the state in which it stands")
    bench.states.clear()
    wait_until(lambda: len(bench.states) > 5, what="repeated states")
    assert {nanoseconds(s.header.stamp) for s in bench.states} == {stands}
    [result] = bench.probe.set(client, paused=False)
    assert result.successful and state(services) == PLAYING
    wait_until(lambda: stamp(bench) > stands, what="time to go on")


def test_there_is_no_way_to_load_a_world(bench):
    services = Services(bench)
    for wanted in (SimulationState.STATE_NO_WORLD, SimulationState.STATE_LOADING_WORLD, 77):
        answer = go(services, wanted)
        assert answer.result == SetSimulationState.Response.INCORRECT_TRANSITION and "no way" in answer.error_message
    assert state(services) == PLAYING


def test_a_hundred_steps_are_a_hundred_control_intervals_and_time_stands_again(scene):
    bench, services = scene
    for steps, total in ((100, 100), (1, 101)):
        assert services(StepSimulation, steps=steps).result.result == OK
        answer = services(GetEntityState, entity="ball")
        assert nanoseconds(answer.state.header.stamp) == total * MS
    wait_until(lambda: stamp(bench) == 101 * MS, what="the state after the steps")
    stamps = [nanoseconds(s.header.stamp) for s in bench.states]
    assert sorted(set(stamps)) == [i * MS for i in range(102)], "every step is published"
    assert state(services) == PAUSED


def test_steps_are_refused_while_time_runs_stopped_or_none(bench):
    services = Services(bench)
    running = services(StepSimulation, steps=1).result
    assert running.result == FAILED and "pause" in running.error_message
    assert go(services, PAUSED).result == OK
    none = services(StepSimulation, steps=0).result
    assert none.result == FAILED and "at least 1" in none.error_message
    assert go(services, STOPPED).result == OK
    stopped = services(StepSimulation, steps=1).result
    assert stopped.result == FAILED and "STOPPED" in stopped.error_message
    assert nanoseconds(services(GetEntityState, entity="arm").state.header.stamp) == 0


def test_playing_ends_steps_that_are_being_made(scene):
    bench, services = scene
    pending = services.start(StepSimulation, steps=10**12)()
    wait_until(lambda: stamp(bench) > 5 * MS, what="steps")
    # The probe has to get through thousands of states first: patience.
    info = services(GetEntityInfo, entity="ball", timeout=60)
    assert info.result.result == OK, "others are answered meanwhile"
    assert services(SetSimulationState, state=SimulationState(state=PLAYING), timeout=60).result.result == OK
    wait_until(pending.done, timeout=60, what="the answer")
    answer = pending.result().result
    assert answer.result == FAILED and "steps were not made" in answer.error_message


def push_the_knee(bench):
    """A command that turns the knee; waits until it has."""
    publisher = bench.probe.publisher(JointState, "joint_command")
    publisher.publish(JointState(name=["knee"], effort=[1.0]))
    wait_until(lambda: abs(bench.axis("knee")[0]) > 0.3, what="the knee to turn")
    return publisher


def test_reset_of_the_state_clears_commands_and_leaves_time_alone(bench):
    services = Services(bench)
    publisher = push_the_knee(bench)
    before = stamp(bench)
    assert services(ResetSimulation, scope=ResetSimulation.Request.SCOPE_STATE).result.result == OK
    wait_until(lambda: abs(bench.axis("knee")[0]) < 1e-6, what="the knee at its start")
    # What was commanded does not come back through a command for another axis.
    publisher.publish(JointState(name=["hip"], position=[0.1]))
    wait_until(lambda: abs(bench.axis("hip")[0] - 0.1) < 0.01, what="the hip")
    assert abs(bench.axis("knee")[0]) < 0.01
    assert stamp(bench) > before
    stamps = [nanoseconds(s.header.stamp) for s in bench.states]
    assert all(b >= a for a, b in zip(stamps, stamps[1:])), "ROS time is monotonic"


def test_reset_of_time_sets_clock_and_states_to_zero_and_tf_goes_on(bench):
    services = Services(bench)
    wait_until(lambda: stamp(bench) > 500 * MS, what="half a second")
    push_the_knee(bench)
    clock, tf = bench.probe.listen(Clock, "/clock"), cyclone_listen("tf", bench.domain)
    wait_until(lambda: len(clock) > 5 and tf.take_all(), what="/clock and /tf")
    position = bench.axis("knee")[0]
    assert services(ResetSimulation, scope=ResetSimulation.Request.SCOPE_TIME).result.result == OK
    back = lambda: [i for i, (a, b) in enumerate(zip(clock, clock[1:])) if nanoseconds(b.clock) < nanoseconds(a.clock)]
    wait_until(back, what="/clock to go back")
    assert nanoseconds(clock[back()[0] + 1].clock) == 0 and len(back()) == 1
    assert abs(bench.axis("knee")[0]) > 0.9 * abs(position), "the state stays"
    frames = []
    stamps = lambda: [nanoseconds(m.transforms[0].header.stamp) for m in frames]
    wait_until(lambda: frames.extend(tf.take_all()) or any(s < 500 * MS for s in stamps()), what="/tf of the new time")
    assert min(stamps()) < 100 * MS, "/tf does not wait for the old time"
    wait_until(lambda: len(bench.diagnostics) > 2, what="diagnostics")
    factors = [float(v.value) for d in bench.diagnostics for st in d.status for v in st.values if v.key == "real-time factor"]
    assert min(factors) > 0, factors


def test_reset_of_everything_is_the_default(bench):
    services = Services(bench)
    for scope in (ResetSimulation.Request.SCOPE_DEFAULT, ResetSimulation.Request.SCOPE_ALL):
        push_the_knee(bench)
        since = len(bench.states) - 1  # the last one before: the next may be after it
        assert services(ResetSimulation, scope=scope).result.result == OK

        def went_back():  # time may have gone on beyond the old one before anybody looks
            stamps = [nanoseconds(s.header.stamp) for s in bench.states[since:]]
            return any(b < a for a, b in zip(stamps, stamps[1:]))

        wait_until(lambda: went_back() and abs(bench.axis("knee")[0]) < 1e-6, what="the start")


def test_other_scopes_are_refused_and_change_nothing(bench):
    services = Services(bench)
    push_the_knee(bench)
    before, position = stamp(bench), bench.axis("knee")[0]
    spawned = services(ResetSimulation, scope=ResetSimulation.Request.SCOPE_SPAWNED).result
    assert spawned.result == UNSUPPORTED and "SPAWNED" in spawned.error_message
    unknown = services(ResetSimulation, scope=8 | 2).result
    assert unknown.result == FAILED and "unknown bits" in unknown.error_message
    wait_until(lambda: stamp(bench) > before + 50 * MS, what="time to go on")
    assert abs(bench.axis("knee")[0]) >= abs(position) * 0.9


def test_stopped_is_paused_with_everything_at_its_start(bench):
    services, client = Services(bench), bench.probe.parameters()
    push_the_knee(bench)
    assert go(services, STOPPED).result == OK
    assert state(services) == STOPPED and bench.probe.get(client, "paused") is True
    wait_until(lambda: stamp(bench) == 0 and abs(bench.axis("knee")[0]) < 1e-6, what="the start")
    assert go(services, STOPPED).result == SetSimulationState.Response.ALREADY_IN_TARGET_STATE
    assert go(services, PAUSED).result == OK and state(services) == PAUSED
    assert go(services, STOPPED).result == OK
    assert bench.probe.set(client, paused=False)[0].successful
    assert state(services) == PLAYING
    wait_until(lambda: stamp(bench) > 0, what="time to go on")


def test_reset_at_start_resets_whenever_it_is_played(start):
    bench = start("-p", "reset_at_start:=true")
    services = Services(bench)
    push_the_knee(bench)
    assert go(services, PAUSED).result == OK
    position, before = pose_of(services, "shank"), stamp(bench)
    assert pose_of(services, "shank") == position, "it stands where it was"
    assert go(services, PLAYING).result == OK
    wait_until(lambda: abs(bench.axis("knee")[0]) < 1e-6, what="the knee at its start")
    assert stamp(bench) >= before, "time goes on"
    client = bench.probe.parameters()
    assert not bench.probe.set(client, reset_at_start=1)[0].successful
    push_the_knee(bench)
    assert bench.probe.set(client, reset_at_start=False)[0].successful
    assert go(services, PAUSED).result == OK
    bench.states.clear()
    assert go(services, PLAYING).result == OK
    wait_until(lambda: len(bench.states) > 100, what="states")
    assert min(abs(s.position[s.name.index("knee")]) for s in bench.states) > 0.2


def test_joints_may_stay_where_they_are_in_a_reset(start, tmp_path):
    bench, services = start_scene(start, tmp_path, "-p", "reset_joints:=false")
    client = bench.probe.parameters()
    assert services(SetEntityState, entity="arm", state=a_state((3.0, 0.0, 1.0))).result.result == OK
    assert services(SetJointAngles, name=["knee"], position=[0.7]).success
    wait_until(lambda: bench.axis("knee")[0] == 0.7, what="the knee")
    assert services(ResetSimulation, scope=ResetSimulation.Request.SCOPE_STATE).result.result == OK
    assert math.dist(pose_of(services, "arm")[:3], (0, 0, 1)) < 1e-9, "the base is at its start"
    assert services(StepSimulation, steps=200).result.result == OK
    wait_until(lambda: stamp(bench) == 200 * MS, what="the steps")
    assert abs(bench.axis("knee")[0] - 0.7) < 1e-6, "the knee is held where it was left"
    assert not bench.probe.set(client, reset_joints=0)[0].successful
    assert bench.probe.set(client, reset_joints=True)[0].successful
    assert services(ResetSimulation, scope=ResetSimulation.Request.SCOPE_STATE).result.result == OK
    wait_until(lambda: bench.axis("knee")[0] == 0, what="the knee at its start")


def test_answers_of_many_fragments_arrive(start, tmp_path):
    """docs/decisions/0032."""
    bodies = "".join(f"  - {{name: ball_{i}, shape: {{sphere: {{radius: 0.1}}}}, mass: 1, pose: [{i}, 0, 1, 0, 0, 0, 1]}}\n" for i in range(100))
    path = tmp_path / "scene.yaml"
    path.write_text("version: 1\nbodies:\n" + bodies)
    services = Services(start("-p", f"scene:={path}"))
    names = services(GetEntities).entities
    assert len(names) > 100
    answer = services(GetEntitiesStates)
    assert answer.result.result == OK and list(answer.entities) == list(names)
    places = [s.pose.position.x for n, s in zip(answer.entities, answer.states) if n.startswith("ball_")]
    assert sorted(round(x) for x in places) == list(range(100))
    assert services(GetEntitiesStates, filters=EntityFilters(filter="^ball_[0-5]$")).result.result == OK


def test_quitting_answers_and_ends_the_node(start):
    bench = start()
    services = Services(bench)
    assert go(services, QUITTING).result == OK
    assert bench.simulator.process.wait(timeout=30) == 0


def test_entities_are_robots_bodies_and_links(scene):
    _, services = scene
    everything = services(GetEntities)
    assert everything.result.result == OK
    links = ["base", "thigh", "shank", "foot-sole", "toe"]
    assert everything.entities == ["arm", "ball", "wall"]
    kind = lambda *c: EntityFilters(categories=[EntityCategory(category=i) for i in c])
    select = lambda filters: services(GetEntities, filters=filters).entities
    C = EntityCategory
    assert select(kind(C.CATEGORY_ROBOT)) == ["arm"]
    assert select(kind(C.CATEGORY_DYNAMIC_OBJECT, C.CATEGORY_STATIC_OBJECT)) == ["ball", "wall"]
    assert select(kind(C.CATEGORY_OBJECT)) == links
    assert select(EntityFilters(filter="^(ba|wa)ll$")) == ["ball", "wall"]
    assert select(EntityFilters(filter="^b", categories=kind(C.CATEGORY_DYNAMIC_OBJECT).categories)) == ["ball"]
    assert select(EntityFilters(filter="nobody")) == []
    info = services(GetEntityInfo, entity="wall")
    assert info.result.result == OK and info.info.category.category == C.CATEGORY_STATIC_OBJECT
    assert services(GetEntityInfo, entity="nobody").result.result == Result.RESULT_NOT_FOUND


@pytest.mark.parametrize("kind", [GetEntities, GetEntitiesStates])
def test_filters_that_cannot_be_applied_are_refused(scene, kind):
    _, services = scene
    bad = services(kind, filters=EntityFilters(filter="(unclosed"))
    assert bad.result.result == FAILED and "(unclosed" in bad.result.error_message and not bad.entities
    tags = services(kind, filters=EntityFilters(tags=TagsFilter(tags=["red"])))
    assert tags.result.result == UNSUPPORTED and "tags" in tags.result.error_message and not tags.entities
    sphere = Bounds(type=Bounds.TYPE_SPHERE, points=[Vector3(), Vector3(x=1.0)])
    bounds = services(kind, filters=EntityFilters(bounds=sphere))
    assert bounds.result.result == UNSUPPORTED and "bounds" in bounds.result.error_message


def test_states_of_entities(scene):
    _, services = scene
    by_name = {}
    for filters in (EntityFilters(), EntityFilters(categories=[EntityCategory(category=EntityCategory.CATEGORY_OBJECT)])):
        answer = services(GetEntitiesStates, filters=filters)
        assert answer.entities == services(GetEntities, filters=filters).entities != []
        by_name.update(zip(answer.entities, answer.states, strict=True))
    assert {s.header.frame_id for s in by_name.values()} == {"world"}
    position = lambda name: [getattr(by_name[name].pose.position, x) for x in "xyz"]
    assert position("ball") == [1, 2, 3] and position("wall") == [5, 0, 0.5]
    assert position("arm") == position("base") == [0, 0, 1]
    assert position("thigh") == [0, 0, 2], "a link, by its frame"
    missing = services(GetEntityState, entity="nobody").result
    assert missing.result == Result.RESULT_NOT_FOUND and "nobody" in missing.error_message


def test_setting_and_getting_the_state_of_a_body_and_a_robot(scene):
    _, services = scene
    quarter = math.sqrt(0.5)
    for entity in ("ball", "arm"):
        wanted = a_state((1.5, -2.0, 4.0), (0.0, 0.0, quarter, quarter), (1.0, 2.0, 3.0), (0.1, 0.2, 0.3), "world")
        answer = services(SetEntityState, entity=entity, state=wanted).result
        assert answer.result == OK, answer.error_message
        got = services(GetEntityState, entity=entity).state
        assert math.dist(pose_of(services, entity), (1.5, -2.0, 4.0, 0, 0, quarter, quarter)) < 1e-12
        twist = got.twist
        assert math.dist([twist.linear.x, twist.linear.y, twist.linear.z], (1, 2, 3)) < 1e-12
        assert math.dist([twist.angular.x, twist.angular.y, twist.angular.z], (0.1, 0.2, 0.3)) < 1e-12
    # Along the axes of the world, whatever way the ball is turned.
    assert services(StepSimulation, steps=10).result.result == OK
    assert math.dist(pose_of(services, "ball")[:3], (1.51, -1.98, 4.03)) < 1e-9


BAD_STATES = [
    ("ball", a_state((math.nan, 0.0, 0.0)), SetEntityState.Response.INVALID_POSE, "not finite"),
    ("ball", a_state(quaternion=(0.0, 0.0, 0.0, 0.0)), SetEntityState.Response.INVALID_POSE, "must be 1"),
    ("ball", a_state(quaternion=(0.0, 0.0, 1.0, 1.0)), SetEntityState.Response.INVALID_POSE, "must be 1"),
    ("ball", a_state(linear=(math.inf, 0.0, 0.0)), FAILED, "not finite"),
    ("ball", a_state(frame="arm"), FAILED, "'arm'"),
    ("wall", a_state(), FAILED, "float"),
    ("shank", a_state(), FAILED, "link"),
    ("nobody", a_state(), Result.RESULT_NOT_FOUND, "nobody"),
]


def test_states_that_cannot_be_set_change_nothing(scene):
    _, services = scene
    before = services(GetEntitiesStates)
    for entity, wanted, code, reason in BAD_STATES:
        answer = services(SetEntityState, entity=entity, state=wanted).result
        assert answer.result == code and reason in answer.error_message, answer
    after = services(GetEntitiesStates)
    assert [s.pose for s in after.states] == [s.pose for s in before.states]
    assert [s.twist for s in after.states] == [s.twist for s in before.states]


def test_a_fixed_base_stays_where_it_is(bench):
    services = Services(bench)
    answer = services(SetEntityState, entity="arm", state=a_state((0.0, 0.0, 5.0))).result
    assert answer.result == FAILED and "fixed base" in answer.error_message and "float" in answer.error_message
    assert pose_of(services, "arm")[:3] == [0, 0, 0]


def test_services_move_with_the_namespace(start):
    bench = start("-r", "__ns:=/left", topic="/left/joint_states")
    assert state(Services(bench, "/left/")) == PLAYING
