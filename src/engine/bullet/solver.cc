#include "solver.h"

namespace realnoid::bullet {

namespace {

// An impulse that only a row of no effect could want, N·s.
constexpr double NEVER = -1e30;

}  // namespace

Solver::Memory* Solver::memory(const btSolverConstraint& row) {
    const int id = static_cast<btTypedConstraint*>(row.m_originalContactPoint)->getUserConstraintId();
    return id >= 0 && id < int(memories_.size()) ? &memories_[id] : nullptr;
}

// Calls `visit(memory, first row, rows)` for each constraint; its rows follow each other.
template <typename Visit>
void Solver::each_joint(Visit visit) {
    auto& rows = m_tmpSolverNonContactConstraintPool;
    for (int first = 0; first < rows.size();) {
        int end = first + 1;
        while (end < rows.size() && rows[end].m_originalContactPoint == rows[first].m_originalContactPoint) end++;
        Memory* m = memory(rows[first]);
        if (m && end - first <= ROWS) visit(*m, first, end - first);
        first = end;
    }
}

void Solver::convertJoints(btTypedConstraint** constraints, int count, const btContactSolverInfo& info) {
    btSequentialImpulseConstraintSolver::convertJoints(constraints, count, info);
    auto& rows = m_tmpSolverNonContactConstraintPool;
    for (int i = 0; i < rows.size(); i++) {
        btSolverConstraint& row = rows[i];
        if (row.m_cfm <= 0 || row.m_jacDiagABInv <= 0) continue;
        const double cfm = row.m_cfm / info.m_timeStep;
        const double mass = 1 / (1 / row.m_jacDiagABInv + cfm);
        row.m_rhs *= mass / row.m_jacDiagABInv;
        row.m_cfm = cfm * mass;
        row.m_jacDiagABInv = mass;
    }
    each_joint([&](Memory& m, int first, int n) {
        if (m.rows != n || m.h <= 0) return;
        for (int i = 0; i < n; i++) {
            btSolverConstraint& row = rows[first + i];
            double impulse = info.m_warmstartingFactor * m.impulse[i] * (info.m_timeStep / m.h);
            impulse = btMin(btMax(impulse, row.m_lowerLimit), row.m_upperLimit);
            row.m_appliedImpulse = impulse;
            btSolverBody& a = m_tmpSolverBodyPool[row.m_solverBodyIdA];
            btSolverBody& b = m_tmpSolverBodyPool[row.m_solverBodyIdB];
            a.internalApplyImpulse(row.m_contactNormal1 * a.internalGetInvMass(), row.m_angularComponentA, impulse);
            b.internalApplyImpulse(row.m_contactNormal2 * b.internalGetInvMass(), row.m_angularComponentB, impulse);
        }
    });
}

void Solver::convertContacts(btPersistentManifold** manifolds, int count, const btContactSolverInfo& info) {
    btSequentialImpulseConstraintSolver::convertContacts(manifolds, count, info);
    for (int i = 0; i < m_tmpSolverContactConstraintPool.size(); i++) {
        btSolverConstraint& row = m_tmpSolverContactConstraintPool[i];
        const auto& p = *static_cast<btManifoldPoint*>(row.m_originalContactPoint);
        if (p.m_combinedRestitution <= 0) continue;
        const btSolverBody& a = m_tmpSolverBodyPool[row.m_solverBodyIdA];
        const btSolverBody& b = m_tmpSolverBodyPool[row.m_solverBodyIdB];
        const double approach = -(row.m_contactNormal1.dot(a.m_linearVelocity) + row.m_relpos1CrossNormal.dot(a.m_angularVelocity) +
                                  row.m_contactNormal2.dot(b.m_linearVelocity) + row.m_relpos2CrossNormal.dot(b.m_angularVelocity));
        if (approach <= info.m_restitutionVelocityThreshold) continue;
        if (p.getDistance() > 0) {
            // Not yet. Rows of contacts have no upper limit in Bullet.
            row.m_rhs = NEVER;
        } else if (row.m_rhsPenetration == 0) {
            // The way out of each other is not to add to the rebound.
            const double push = -p.getDistance() * info.m_erp2 / info.m_timeStep * row.m_jacDiagABInv;
            row.m_rhs -= push;
            row.m_rhsPenetration = push;
        }
    }
}

btScalar Solver::solveGroupCacheFriendlyFinish(btCollisionObject** bodies, int count, const btContactSolverInfo& info) {
    each_joint([&](Memory& m, int first, int n) {
        m.rows = n;
        m.h = info.m_timeStep;
        for (int i = 0; i < n; i++) m.impulse[i] = m_tmpSolverNonContactConstraintPool[first + i].m_appliedImpulse;
    });
    return btSequentialImpulseConstraintSolver::solveGroupCacheFriendlyFinish(bodies, count, info);
}

}  // namespace realnoid::bullet
