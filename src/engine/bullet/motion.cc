#include "motion.h"
#include <cmath>

namespace realnoid::bullet {

btTransform ahead(const btTransform& from, const btRigidBody& b, double time) {
    const btVector3& w = b.getAngularVelocity();
    const double half = 0.5 * time * w.length();
    // sin(half)/|w|, also without a turn.
    const double scale = 0.5 * time * (half * half < 1e-8 ? 1 - half * half / 6 : std::sin(half) / half);
    const btQuaternion turn(scale * w.x(), scale * w.y(), scale * w.z(), std::cos(half));
    return btTransform((turn * from.getRotation()).normalized(), from.getOrigin() + b.getLinearVelocity() * time);
}

void Dynamics::integrateTransforms(btScalar h) {
    before_.clear();
    for (int i = 0; i < m_nonStaticRigidBodies.size(); i++) before_.push_back(m_nonStaticRigidBodies[i]->getWorldTransform());
    btDiscreteDynamicsWorld::integrateTransforms(h);
    for (int i = 0; i < m_nonStaticRigidBodies.size(); i++) {
        btRigidBody& b = *m_nonStaticRigidBodies[i];
        if (b.isActive() && !b.isStaticOrKinematicObject()) b.proceedToTransform(ahead(before_[i], b, h));
    }
}

}  // namespace realnoid::bullet
