//! All that is unsafe of the engine `physx`: calls into PhysX 5.1 (physx-sys), behind a face that is safe. Nothing outside of this
//! folder names PhysX.
//!
//! PhysX has one foundation for a process. It is made with the first world and never freed: other worlds, and threads, share it.
//! All of a scene's work is done in the thread that steps it (no worker threads), so what PhysX reports as an error is that
//! thread's.

mod cook;
mod sim;

pub use cook::{Cooked, NoHull, cook_hull, cook_mesh};
pub use sim::Sim;

use physx_sys::*;
use std::cell::RefCell;
use std::ffi::{CStr, c_void};
use std::ptr::{NonNull, null_mut};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

/// `PX_PHYSICS_VERSION` of the headers that physx-sys 0.11.5 comes with.
const VERSION: u32 = version(5, 1, 3);

static LIVE: AtomicUsize = AtomicUsize::new(0);
/// Scenes and what they share are made and freed one after the other.
static MAKING: Mutex<()> = Mutex::new(());
static PROCESS: OnceLock<Option<Process>> = OnceLock::new();

thread_local! {
    static FAULT: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// How many pieces of memory PhysX holds in this process; the foundation's own stay.
pub fn allocations() -> usize {
    LIVE.load(Ordering::Relaxed)
}

extern "C" fn allocate(size: u64, _: *const c_void, _: *const c_void, _: u32, _: *const c_void) -> *mut c_void {
    const ALIGNMENT: usize = 16;
    LIVE.fetch_add(1, Ordering::Relaxed);
    // SAFETY: the size is a multiple of the alignment, which is a power of two.
    unsafe { libc::aligned_alloc(ALIGNMENT, (size as usize).max(1).next_multiple_of(ALIGNMENT)) }
}

extern "C" fn free(memory: *const c_void, _: *const c_void) {
    if !memory.is_null() {
        LIVE.fetch_sub(1, Ordering::Relaxed);
    }
    // SAFETY: PhysX frees what `allocate` gave it, once; nothing is freed for a null.
    unsafe { libc::free(memory.cast_mut()) }
}

/// Keeps the first error of a call; warnings and information are not errors.
unsafe extern "C" fn report(code: PxErrorCode, message: *const i8, _: *const i8, _: u32, _: *const c_void) {
    if matches!(code, PxErrorCode::DebugInfo | PxErrorCode::DebugWarning | PxErrorCode::PerfWarning) {
        return;
    }
    // SAFETY: PhysX hands over a string that ends with 0.
    let text = unsafe { CStr::from_ptr(message.cast()) }.to_string_lossy().into_owned();
    // No place to keep it is left only while a thread ends.
    let _ = FAULT.try_with(|fault| fault.borrow_mut().get_or_insert(text).len());
}

/// What PhysX reports as an error of a call, if it does.
fn watched<T>(call: impl FnOnce() -> T) -> Result<T, String> {
    FAULT.with(|fault| fault.borrow_mut().take());
    let done = call();
    match FAULT.with(|fault| fault.borrow_mut().take()) {
        Some(fault) => Err(format!("physx: {fault}")),
        None => Ok(done),
    }
}

/// The SDK's one object that makes all others.
struct Process(NonNull<PxPhysics>);

// SAFETY: PxPhysics guards what it has in common with mutexes of its own, and is never freed.
unsafe impl Send for Process {}
// SAFETY: as above.
unsafe impl Sync for Process {}

fn making() -> MutexGuard<'static, ()> {
    MAKING.lock().unwrap_or_else(PoisonError::into_inner)
}

fn physics() -> Result<*mut PxPhysics, String> {
    let process = PROCESS.get_or_init(|| {
        // SAFETY: the callbacks are functions and need no data; they, the foundation and the SDK are never freed.
        unsafe {
            let allocator = create_alloc_callback(allocate, free, null_mut());
            let foundation = phys_PxCreateFoundation(VERSION, allocator, create_error_callback(report, null_mut()));
            let foundation = NonNull::new(foundation)?;
            let scale = PxTolerancesScale_new(1.0, 10.0);
            let physics = phys_PxCreatePhysics(VERSION, foundation.as_ptr(), &scale, false, null_mut(), null_mut());
            NonNull::new(physics).map(Process)
        }
    });
    process.as_ref().map(|p| p.0.as_ptr()).ok_or_else(|| "physx: no foundation".into())
}
