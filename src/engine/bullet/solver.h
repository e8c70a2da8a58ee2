// Bullet's sequential impulses, with the CFM of joints as J-18 defines it.
#pragma once
#include "BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h"

namespace realnoid::bullet {

// In Bullet the CFM of a joint's row is a share of the row's own effective mass, and the iteration diverges from a share of 1 on.
// Here it is a velocity per force, as of contacts: the row's equation is J·v + CFM/h · impulse = wanted.
class Solver : public btSequentialImpulseConstraintSolver {
public:
    BT_DECLARE_ALIGNED_ALLOCATOR();

protected:
    void convertJoints(btTypedConstraint** constraints, int count, const btContactSolverInfo& info) override {
        btSequentialImpulseConstraintSolver::convertJoints(constraints, count, info);
        for (int i = 0; i < m_tmpSolverNonContactConstraintPool.size(); i++) {
            btSolverConstraint& row = m_tmpSolverNonContactConstraintPool[i];
            if (row.m_cfm <= 0 || row.m_jacDiagABInv <= 0) continue;
            const double cfm = row.m_cfm / info.m_timeStep;
            const double mass = 1 / (1 / row.m_jacDiagABInv + cfm);
            row.m_rhs *= mass / row.m_jacDiagABInv;
            row.m_cfm = cfm * mass;
            row.m_jacDiagABInv = mass;
        }
    }
};

}  // namespace realnoid::bullet
