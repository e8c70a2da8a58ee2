#include "motion.h"
#include <cmath>
#include "LinearMath/btTransformUtil.h"

namespace realnoid::bullet {

namespace {

bool is_cut(const btRigidBody& b, double time) { return b.getAngularVelocity().length() * std::abs(time) > ANGULAR_MOTION_THRESHOLD; }

}  // namespace

btTransform ahead(const btTransform& from, const btRigidBody& b, double time) {
    const btVector3 &w = b.getAngularVelocity(), &v = b.getLinearVelocity();
    if (!is_cut(b, time)) {
        btTransform at;
        btTransformUtil::integrateTransform(from, v, w, time, at);
        return at;
    }
    const btQuaternion turn(w.normalized(), w.length() * time);
    return btTransform((turn * from.getRotation()).normalized(), from.getOrigin() + v * time);
}

void Dynamics::integrateTransforms(btScalar h) {
    before_.clear();
    for (int i = 0; i < m_nonStaticRigidBodies.size(); i++) before_.push_back(m_nonStaticRigidBodies[i]->getWorldTransform());
    btDiscreteDynamicsWorld::integrateTransforms(h);
    for (int i = 0; i < m_nonStaticRigidBodies.size(); i++) {
        btRigidBody& b = *m_nonStaticRigidBodies[i];
        if (b.isActive() && is_cut(b, h)) b.proceedToTransform(ahead(before_[i], b, h));
    }
}

}  // namespace realnoid::bullet
