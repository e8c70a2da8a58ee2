// Bullet's sequential impulses with three differences.
#pragma once
#include <array>
#include <vector>
#include "BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h"

namespace realnoid::bullet {

// 1. The CFM of a joint is what J-18 says. In Bullet it is a share of the row's own effective mass, and the iteration diverges
//    from a share of 1 on. Here it is a velocity per force, as in Bullet's contacts: J·v + CFM/h · impulse = wanted.
// 2. Joints start from 0.85 of the impulses of the last step, as Bullet's contacts do. Without that ten iterations leave a servo
//    far short of its load: its row is about the centre of mass, and has to work against those that hold the hinge. With all of
//    the impulses the humanoid's servos ring, and at 0.1 ms they throw it apart.
// 3. What bounces does so when it touches. Bullet begins at the gap of which it knows that it will close, and takes the part of
//    the speed that closes it from the rebound, up to all of it.
class Solver : public btSequentialImpulseConstraintSolver {
public:
    BT_DECLARE_ALIGNED_ALLOCATOR();

    // Room for the impulses of a constraint; its user id from here on.
    int remember() {
        memories_.emplace_back();
        return int(memories_.size()) - 1;
    }

protected:
    void convertJoints(btTypedConstraint** constraints, int count, const btContactSolverInfo& info) override;
    void convertContacts(btPersistentManifold** manifolds, int count, const btContactSolverInfo& info) override;
    btScalar solveGroupCacheFriendlyFinish(btCollisionObject** bodies, int count, const btContactSolverInfo& info) override;

private:
    // A limited degree of freedom has two rows, and a motor one more.
    static constexpr int ROWS = 18;
    struct Memory {
        std::array<double, ROWS> impulse{};
        int rows = 0;
        double h = 0;
    };
    std::vector<Memory> memories_;

    Memory* memory(const btSolverConstraint& row);
    template <typename Visit>
    void each_joint(Visit visit);
};

}  // namespace realnoid::bullet
