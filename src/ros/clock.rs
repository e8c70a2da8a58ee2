//! The monotonic clock, absolute sleeps and real-time scheduling of the calling thread.

use std::io;

const NS_PER_S: u64 = 1_000_000_000;

/// Monotonic time, ns.
pub fn now_ns() -> u64 {
    let mut t = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: `t` is a valid timespec that outlives the call.
    unsafe { libc::clock_gettime(libc::CLOCK_MONOTONIC, &mut t) };
    t.tv_sec as u64 * NS_PER_S + t.tv_nsec as u64
}

/// Sleeps until monotonic time `ns`; may return early when a signal arrives.
pub fn sleep_until_ns(ns: u64) {
    let t = libc::timespec { tv_sec: (ns / NS_PER_S) as _, tv_nsec: (ns % NS_PER_S) as _ };
    // SAFETY: `t` is a valid timespec; a null remainder is allowed with TIMER_ABSTIME.
    unsafe { libc::clock_nanosleep(libc::CLOCK_MONOTONIC, libc::TIMER_ABSTIME, &t, std::ptr::null_mut()) };
}

/// Gives the calling thread SCHED_FIFO `priority` (1…99) if it is above 0, and the finest timer slack in any case.
/// `Err` says why the system refused; the thread then keeps its ordinary priority.
pub fn prepare_thread(priority: i32) -> Result<(), String> {
    // SAFETY: PR_SET_TIMERSLACK takes one integer and touches only the calling thread.
    unsafe { libc::prctl(libc::PR_SET_TIMERSLACK, 1_usize) };
    if priority <= 0 {
        return Ok(());
    }
    let parameters = libc::sched_param { sched_priority: priority };
    // SAFETY: `parameters` is valid and outlives the call; 0 is the calling thread.
    let refused = unsafe { libc::sched_setscheduler(0, libc::SCHED_FIFO, &parameters) } != 0;
    if refused { Err(io::Error::last_os_error().to_string()) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sleeps_at_least_until_the_deadline() {
        let deadline = now_ns() + 3_000_000;
        sleep_until_ns(deadline);
        assert!(now_ns() >= deadline);
    }

    #[test]
    fn an_impossible_priority_is_refused_with_the_reason() {
        let reason = prepare_thread(1000).unwrap_err();
        assert!(!reason.is_empty());
    }
}
