// A btDiscreteDynamicsWorld made of a Spec, stepped and read back.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <stdexcept>
#include "BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h"
#include "btBulletDynamicsCommon.h"
#include "realnoid/src/engine/bullet/bridge.rs.h"
#include "drives.h"
#include "motion.h"
#include "shapes.h"
#include "surfaces.h"
#include "solver.h"

namespace realnoid::bullet {

namespace {

std::atomic<std::size_t> alive{0};

btVector3 vec(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }
std::array<double, 3> arr(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
btTransform transform(const std::array<double, 7>& a) {
    return btTransform(btQuaternion(a[3], a[4], a[5], a[6]), btVector3(a[0], a[1], a[2]));
}

struct Sleep {
    double after = -1;
    double slow = 0;
};

}  // namespace

// Destroyed from below: constraints, bodies, world, what the world uses, shapes.
struct World::Impl {
    std::vector<std::pair<int, int>> excluded;
    std::vector<std::unique_ptr<Leaf>> leaves;
    std::vector<std::unique_ptr<btCompoundShape>> compounds;
    // Of bodies that touch nothing: Bullet does not move a body without a shape.
    btEmptyShape nothing;
    Filter filter;
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    Solver solver;
    Dynamics world{&dispatcher, &broadphase, &solver, &configuration};
    // The world's side of joints; not among the bodies of the world.
    btRigidBody ground{btRigidBody::btRigidBodyConstructionInfo(0, nullptr, nullptr)};
    std::vector<std::unique_ptr<btRigidBody>> bodies;
    std::vector<Sleep> sleeps;
    std::vector<std::unique_ptr<btRigidBody>> standing;
    std::vector<btJointFeedback> feedback;
    std::vector<std::unique_ptr<btGeneric6DofSpring2Constraint>> joints;
    std::vector<Slide> slides;
    std::vector<Drive> drives;
    std::vector<Pair> pairs;
    double h = 0;

    ~Impl();
    void configure();
    void add_shapes(const Spec& spec);
    void add_bodies(const Spec& spec);
    void add_body(const BodySpec& spec, btCollisionShape* shape);
    void allow();
    void add_joint(const JointSpec& spec, btJointFeedback& feedback);
    void add_motor(const Spec& spec, const Motor& motor);
    std::unique_ptr<btGeneric6DofSpring2Constraint> constraint(const JointSpec& spec);
    void add_pair(const Spec& spec, const PairSpec& pair);
    void fall_asleep();
    void drift(double time);
};

World::Impl::~Impl() {
    for (auto& p : pairs) world.removeConstraint(p.constraint.get());
    for (auto& d : drives) world.removeConstraint(d.constraint.get());
    for (auto& j : joints) world.removeConstraint(j.get());
    for (auto& b : bodies) world.removeRigidBody(b.get());
    for (auto& b : standing) world.removeRigidBody(b.get());
}

void World::Impl::configure() {
    set_callbacks();
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher);
    btContactSolverInfo& info = world.getSolverInfo();
    info.m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS | SOLVER_INTERLEAVE_CONTACT_AND_FRICTION_CONSTRAINTS;
    info.m_solverMode &= ~SOLVER_RANDMIZE_ORDER;
    info.m_jointFeedbackInWorldSpace = true;
    world.getPairCache()->setOverlapFilterCallback(&filter);
    world.setForceUpdateAllAabbs(false);
}

void World::Impl::add_shapes(const Spec& spec) {
    for (std::size_t i = 0; i + 1 < spec.excluded.size(); i += 2) excluded.emplace_back(spec.excluded[i], spec.excluded[i + 1]);
    compounds.resize(spec.bodies.size());
    for (const ShapeSpec& s : spec.shapes) {
        auto leaf = make_leaf(s);
        leaf->index = int(leaves.size());
        leaf->excluded = &excluded;
        const btTransform pose = transform(s.pose) * btTransform(btQuaternion::getIdentity(), btVector3(0, 0, leaf->shift));
        if (s.body >= int(spec.bodies.size())) throw std::out_of_range("a shape is on a body that is not there");
        if (s.body >= 0) {
            if (leaf->shape->isNonMoving()) throw std::invalid_argument("a plane or a mesh surface cannot move");
            auto& compound = compounds[s.body];
            if (!compound) compound = std::make_unique<btCompoundShape>();
            compound->addChildShape(pose, leaf->shape.get());
        } else {
            auto body = std::make_unique<btRigidBody>(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, leaf->shape.get()));
            body->setWorldTransform(pose);
            standing.push_back(std::move(body));
        }
        leaves.push_back(std::move(leaf));
    }
}

void World::Impl::add_body(const BodySpec& s, btCollisionShape* shape) {
    btRigidBody::btRigidBodyConstructionInfo info(s.mass, nullptr, shape, vec(s.inertia));
    auto body = std::make_unique<btRigidBody>(info);
    body->setCenterOfMassTransform(transform(s.moving.pose));
    body->setLinearVelocity(vec(s.moving.linear));
    body->setAngularVelocity(vec(s.moving.angular));
    body->setDamping(s.damping[0], s.damping[1]);
    body->setSleepingThresholds(s.sleep[0], s.sleep[1]);
    if (s.sleep[2] < 0) body->setActivationState(DISABLE_DEACTIVATION);
    sleeps.push_back({s.sleep[2], 0});
    bodies.push_back(std::move(body));
}

void World::Impl::add_bodies(const Spec& spec) {
    for (std::size_t i = 0; i < spec.bodies.size(); i++) {
        btCollisionShape* compound = compounds[i].get();
        add_body(spec.bodies[i], compound ? compound : &nothing);
    }
    std::vector<btRigidBody*> all;
    for (auto& b : bodies) all.push_back(b.get());
    for (auto& b : standing) all.push_back(b.get());
    for (std::size_t i = 0; i < all.size(); i++) {
        all[i]->setUserIndex(int(i));
        set_surface(*all[i]);
    }
    allow();
    // Mass 0 makes a body static, whose pair with another one is never asked for.
    for (btRigidBody* b : all) world.addRigidBody(b);
}

void World::Impl::allow() {
    std::vector<const btCollisionObject*> all;
    for (auto& b : bodies) all.push_back(b.get());
    for (auto& b : standing) all.push_back(b.get());
    auto leaves_of = [](const btCollisionObject* o) {
        const btCollisionShape* shape = o->getCollisionShape();
        std::vector<const Leaf*> found;
        if (!leaf_at(o, 0)) return found;
        const int n = shape->isCompound() ? static_cast<const btCompoundShape*>(shape)->getNumChildShapes() : 1;
        for (int i = 0; i < n; i++) found.push_back(leaf_at(o, i));
        return found;
    };
    filter.allowed.assign(all.size(), std::vector<bool>(all.size(), false));
    for (std::size_t i = 0; i < all.size(); i++)
        for (std::size_t j = 0; j < i; j++) {
            const auto mine = leaves_of(all[i]), others = leaves_of(all[j]);
            const bool some = std::any_of(mine.begin(), mine.end(), [&](const Leaf* a) {
                return std::any_of(others.begin(), others.end(), [&](const Leaf* b) { return may_touch(a, b); });
            });
            const bool moves = !all[i]->isStaticObject() || !all[j]->isStaticObject();
            filter.allowed[i][j] = filter.allowed[j][i] = some && moves;
        }
}

std::unique_ptr<btGeneric6DofSpring2Constraint> World::Impl::constraint(const JointSpec& s) {
    const int n = int(bodies.size());
    if (s.parent < -1 || s.parent >= n || s.child < 0 || s.child >= n || s.parent == s.child)
        throw std::out_of_range("a joint is on a body that is not there");
    btRigidBody& parent = s.parent < 0 ? ground : *bodies[s.parent];
    // RO_XYZ: turns about z, then y, then x; their angles have the opposite sign in Bullet.
    return std::make_unique<btGeneric6DofSpring2Constraint>(parent, *bodies[s.child], transform(s.frame_in_parent),
                                                            transform(s.frame_in_child), RO_XYZ);
}

void World::Impl::add_joint(const JointSpec& s, btJointFeedback& fb) {
    auto c = constraint(s);
    for (int i = 0; i < 6; i++) {
        if (i < 3)
            c->setLimit(i, s.lower[i], s.upper[i]);
        else if (s.lower[i] > s.upper[i])
            c->setLimit(i, 1, -1);
        else
            c->setLimitReversed(i, s.lower[i], s.upper[i]);
        c->setParam(BT_CONSTRAINT_STOP_ERP, s.erp[i], i);
        c->setParam(BT_CONSTRAINT_STOP_CFM, s.cfm[i], i);
    }
    c->setUserConstraintId(solver.remember());
    c->setJointFeedback(&fb);
    world.addConstraint(c.get(), false);
    if (s.lower[0] != s.upper[0])
        slides.push_back({c.get(), transform(s.frame_in_parent), transform(s.frame_in_child), s.lower[0], s.upper[0]});
    joints.push_back(std::move(c));
}

void World::Impl::add_motor(const Spec& spec, const Motor& motor) {
    if (motor.joint >= spec.joints.size() || motor.dof >= 6) throw std::out_of_range("a motor is on a joint that is not there");
    Drive d{constraint(spec.joints[motor.joint]), int(motor.dof), motor.far ? joints[motor.joint].get() : nullptr};
    for (int i = 0; i < 6; i++) d.constraint->setLimit(i, 1, -1);
    d.constraint->setUserConstraintId(solver.remember());
    d.constraint->enableFeedback(true);
    d.constraint->setEnabled(false);
    world.addConstraint(d.constraint.get(), false);
    drives.push_back(std::move(d));
}

// Its torque is booked with that of its joint.
void World::Impl::add_pair(const Spec& spec, const PairSpec& pair) {
    if (pair.joint >= spec.joints.size()) throw std::out_of_range("a pair is on a joint that is not there");
    const JointSpec& joint = spec.joints[pair.joint];
    Pair p{constraint(joint), transform(joint.frame_in_child)};
    for (int i = 0; i < 6; i++) p.constraint->setLimit(i, 1, -1);
    p.constraint->setParam(BT_CONSTRAINT_STOP_ERP, pair.erp, 3);
    p.constraint->setUserConstraintId(solver.remember());
    p.constraint->setJointFeedback(&feedback[pair.joint]);
    p.constraint->setEnabled(false);
    world.addConstraint(p.constraint.get(), false);
    pairs.push_back(std::move(p));
}

// B-9: each body has its own delay, Bullet one for all of a process. A body is told that its time is over.
void World::Impl::fall_asleep() {
    for (std::size_t i = 0; i < bodies.size(); i++) {
        Sleep& s = sleeps[i];
        btRigidBody& b = *bodies[i];
        if (s.after < 0) continue;
        const bool slow = b.getLinearVelocity().length() <= b.getLinearSleepingThreshold() &&
                          b.getAngularVelocity().length() <= b.getAngularSleepingThreshold();
        s.slow = slow ? s.slow + h : 0;
        b.setDeactivationTime(s.slow > s.after ? 2 * gDeactivationTime : 0);
    }
}

// Bullet moves a body by the velocity that it got from forces at the place where it was. That is of second order if the place is
// half a step ahead of the velocity (leapfrog). So bodies are put that much ahead, and read that much behind.
void World::Impl::drift(double time) {
    if (time == 0) return;
    for (auto& b : bodies) b->setCenterOfMassTransform(ahead(*b, time));
}

World::World(const Spec& spec) : impl_(std::make_unique<Impl>()) {
    Impl& w = *impl_;
    w.configure();
    w.add_shapes(spec);
    w.add_bodies(spec);
    w.feedback.resize(spec.joints.size());
    for (std::size_t i = 0; i < spec.joints.size(); i++) w.add_joint(spec.joints[i], w.feedback[i]);
    for (const Motor& motor : spec.motors) w.add_motor(spec, motor);
    for (const PairSpec& pair : spec.pairs) w.add_pair(spec, pair);
    alive++;
}

World::~World() { alive--; }

void World::step(const StepInput& in, rust::Slice<const MotorInput> motors, rust::Slice<const PairInput> pairs,
                 rust::Slice<double> efforts, rust::Slice<Moving> bodies) {
    Impl& w = *impl_;
    if (motors.size() != w.drives.size() || efforts.size() != w.drives.size() || bodies.size() != w.bodies.size() ||
        pairs.size() != w.pairs.size())
        throw std::out_of_range("a step of another world");
    const btVector3 gravity = vec(in.gravity);
    w.drift(0.5 * (in.h - w.h));
    w.h = in.h;
    btContactSolverInfo& info = w.world.getSolverInfo();
    info.m_numIterations = in.iterations;
    // What weight adds to a speed within a step does not bounce.
    info.m_restitutionVelocityThreshold = 2 * gravity.length() * in.h;
    if (gravity != w.world.getGravity()) {
        wake();
        w.world.setGravity(gravity);
    }
    for (const Slide& slide : w.slides) slide.follow();
    for (std::size_t i = 0; i < w.drives.size(); i++) w.drives[i].set(motors[i], w.ground);
    for (std::size_t i = 0; i < w.pairs.size(); i++) w.pairs[i].set(pairs[i]);
    w.world.stepSimulation(in.h, 0);
    w.fall_asleep();
    for (std::size_t i = 0; i < w.drives.size(); i++) {
        auto& c = *w.drives[i].constraint;
        efforts[i] = c.isEnabled() ? -c.getAppliedImpulse() / in.h : 0;
    }
    for (std::size_t i = 0; i < w.bodies.size(); i++) {
        const btRigidBody& b = *w.bodies[i];
        const btTransform at = ahead(b, -0.5 * in.h);
        const btVector3& p = at.getOrigin();
        const btQuaternion q = at.getRotation();
        bodies[i] = {{p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()}, arr(b.getAngularVelocity()), arr(b.getLinearVelocity())};
    }
}

void World::contacts(rust::Vec<Contact>& out) const {
    const Impl& w = *impl_;
    out.clear();
    auto& dispatcher = const_cast<btCollisionDispatcher&>(w.dispatcher);
    for (int m = 0; m < dispatcher.getNumManifolds(); m++) {
        const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(m);
        for (int i = 0; i < manifold.getNumContacts(); i++) {
            const btManifoldPoint& p = manifold.getContactPoint(i);
            const Leaf* a = leaf_at(manifold.getBody0(), p.m_index0);
            const Leaf* b = leaf_at(manifold.getBody1(), p.m_index1);
            if (!a || !b) continue;
            // Bullet's normal and its impulses are on the first body.
            btVector3 normal = -p.m_normalWorldOnB;
            btVector3 force = p.m_normalWorldOnB * p.m_appliedImpulse + p.m_lateralFrictionDir1 * p.m_appliedImpulseLateral1 +
                              p.m_lateralFrictionDir2 * p.m_appliedImpulseLateral2;
            force *= w.h > 0 ? -1 / w.h : 0;
            int first = a->index, second = b->index;
            if (first > second) {
                std::swap(first, second);
                normal = -normal;
                force = -force;
            }
            const btVector3 point = 0.5 * (p.getPositionWorldOnA() + p.getPositionWorldOnB());
            out.push_back({{first, second}, arr(point), arr(normal), -p.getDistance(), arr(force)});
        }
    }
    std::stable_sort(out.begin(), out.end(), [](const Contact& a, const Contact& b) { return a.shapes < b.shapes; });
}

void World::joint_forces(rust::Slice<JointForce> out) const {
    const auto& feedback = impl_->feedback;
    if (out.size() != feedback.size()) throw std::out_of_range("joints of another world");
    for (std::size_t i = 0; i < feedback.size(); i++)
        out[i] = {arr(feedback[i].m_appliedForceBodyB), arr(feedback[i].m_appliedTorqueBodyB)};
}

void World::wake() {
    for (std::size_t i = 0; i < impl_->bodies.size(); i++) {
        impl_->bodies[i]->activate(true);
        impl_->sleeps[i].slow = 0;
    }
}

std::unique_ptr<World> build(const Spec& spec) { return std::make_unique<World>(spec); }

std::size_t worlds() { return alive; }

}  // namespace realnoid::bullet
