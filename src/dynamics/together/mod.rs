//! Hybrid dynamics of several worlds in one pass: each world runs by itself until it asks for accelerations, and waits there until
//! the others have asked, too. So there is one way to step a world, and every robot has the bits that it has alone.
//!
//! Who runs is a coroutine with a stack of its own, so it may wait in the midst of a step.

mod lanes;
mod pass;

use super::{LaneKind, Workspace};
use crate::model::Model;
use corosensei::stack::DefaultStack;
use corosensei::{Coroutine, CoroutineResult, Yielder};
use pass::Pass;
use std::cell::Cell;
use std::ptr::NonNull;

/// Bytes of a task's stack, as of a thread.
const STACK: usize = 2 << 20;

thread_local! {
    /// Through whom the task that has its turn on this thread asks.
    static ASKING: Cell<Option<Asking>> = const { Cell::new(None) };
    static TURN: Cell<Option<Turn>> = const { Cell::new(None) };
}

/// What a task that waits wants to be computed, and where it is to be written. It borrows all that for as long as it waits.
#[derive(Clone, Copy)]
struct Request {
    m: NonNull<Model>,
    ws: NonNull<Workspace<f64>>,
    q: NonNull<[f64]>,
    v: NonNull<[f64]>,
    gravity: [f64; 3],
    qdd: NonNull<[f64]>,
}

/// A task that has its turn.
#[derive(Clone, Copy)]
pub(super) struct Asking(NonNull<Yielder<bool, Request>>);

/// That of this thread.
#[inline(always)]
pub(super) fn asking() -> Option<Asking> {
    ASKING.get()
}

impl Asking {
    /// Waits for what [`super::aba_hybrid`] computes. `false` if nobody shares a pass with it.
    #[cold]
    pub fn ask(
        self,
        m: &Model,
        ws: &mut Workspace<f64>,
        (q, v): (&[f64], &[f64]),
        gravity: [f64; 3],
        qdd: &mut [f64],
    ) -> bool {
        let (ws, qdd) = (NonNull::from(ws), NonNull::from(qdd));
        let request = Request { m: m.into(), ws, q: q.into(), v: v.into(), gravity, qdd };
        // SAFETY: it is that of the task that runs here, and lives as long as the task.
        let served = unsafe { self.0.as_ref() }.suspend(request);
        ASKING.set(Some(self));
        served
    }
}

/// What tasks have asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Asked {
    /// Passes.
    pub all: u64,
    /// Of them, those that were made together with others.
    pub together: u64,
}

/// A task's turn; times as `clock` of [`take_turns`] gives them, s.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    /// What the task has had before, with its share of common passes.
    pub before: f64,
    /// When the turn began.
    pub since: f64,
}

/// That of the task that runs on this thread; `None` outside of [`take_turns`].
pub fn own_turn() -> Option<Turn> {
    TURN.get()
}

/// A task.
struct Seat<R> {
    task: Coroutine<bool, Request, R>,
    /// Time that it has had, s.
    spent: f64,
}

/// Runs tasks in turns on this thread, `count` at a time (32 at most): what they ask of [`super::aba_hybrid`] is computed in
/// common passes in lanes of this kind, where models and locks allow. `next` is asked for tasks until it has none, and `done` gets what
/// they return. `clock` gives seconds from any beginning. Returns what has been asked for.
pub fn take_turns<R: 'static, F: FnOnce() -> R + 'static>(
    (kind, count): (LaneKind, usize),
    clock: fn() -> f64,
    mut next: impl FnMut() -> Option<F>,
    mut done: impl FnMut(R),
) -> Asked {
    let count = count.clamp(1, pass::MOST);
    let (mut seats, mut requests) = (Vec::with_capacity(count), Vec::with_capacity(count));
    let (mut pass, mut clock) = (Pass::new(kind), Clock::new(clock));
    let (mut more, mut asked) = (true, Asked::default());
    loop {
        while more && seats.len() < count {
            let Some(task) = next() else {
                more = false;
                break;
            };
            clock.take();
            let mut seat = match Seat::new(task, count) {
                Ok(seat) => seat,
                Err(task) => {
                    done(task());
                    continue;
                }
            };
            match seat.resume(true, &mut clock) {
                Ok(request) => {
                    seats.push(seat);
                    requests.push(request);
                }
                Err(result) => done(result),
            }
        }
        if seats.is_empty() {
            return asked;
        }
        let served = pass.serve(&requests);
        asked.all += requests.len() as u64;
        asked.together += u64::from(served.count_ones());
        let share = clock.take() / seats.len() as f64;
        let mut k = 0;
        requests.clear();
        seats.retain_mut(|seat| {
            seat.spent += share;
            let own = served & (1 << k) != 0;
            k += 1;
            match seat.resume(own, &mut clock) {
                Ok(request) => requests.push(request),
                Err(result) => {
                    done(result);
                    clock.take();
                    return false;
                }
            }
            true
        });
    }
}

impl<R: 'static> Seat<R> {
    /// Gives the task back where it is to be alone, or there is no room for a stack.
    fn new<F: FnOnce() -> R + 'static>(task: F, count: usize) -> Result<Self, F> {
        let stack = if count > 1 { DefaultStack::new(STACK).ok() } else { None };
        let Some(stack) = stack else { return Err(task) };
        // A coroutine carries what it begins with on its stack, a page at most.
        let task = Box::new(task);
        let begin = move |asking: &Yielder<bool, Request>, _| {
            ASKING.set(Some(Asking(asking.into())));
            task()
        };
        Ok(Self { task: Coroutine::with_stack(stack, begin), spent: 0.0 })
    }

    /// Lets it run until it asks or ends.
    fn resume(&mut self, served: bool, clock: &mut Clock) -> Result<Request, R> {
        TURN.set(Some(Turn { before: self.spent, since: clock.last }));
        let turn = End;
        let result = self.task.resume(served);
        drop(turn);
        self.spent += clock.take();
        match result {
            CoroutineResult::Yield(request) => Ok(request),
            CoroutineResult::Return(result) => Err(result),
        }
    }
}

/// Ends a turn, also one that panics: nobody asks through a task that is not there.
struct End;

impl Drop for End {
    fn drop(&mut self) {
        ASKING.set(None);
        TURN.set(None);
    }
}

/// The end of a turn is the beginning of the next.
struct Clock {
    now: fn() -> f64,
    /// When it was last looked at.
    last: f64,
}

impl Clock {
    fn new(now: fn() -> f64) -> Self {
        Self { now, last: now() }
    }

    /// Since it was last looked at, s.
    fn take(&mut self) -> f64 {
        let now = (self.now)();
        now - std::mem::replace(&mut self.last, now)
    }
}
