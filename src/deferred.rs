// SPDX-License-Identifier: MIT OR Apache-2.0
//! Work that a thread does once it holds no lock of the process any more. A host's callback may wait for another
//! thread's call, so none may run under a lock that such a call may need: bhr's own, wgpu's, a driver's. Messages that
//! are logged under them wait here until the outermost [`Holding`] ends. Knows neither locks nor messages.

use std::cell::{Cell, RefCell};

/// Bytes that a thread keeps at most. Only a host that listens to every word of the shader compiler comes near.
const MOST_BYTES: usize = 16 << 20;

thread_local! {
    static DEPTH: Cell<u32> = const { Cell::new(0) };
    static WAITING: RefCell<Waiting> = const { RefCell::new(Waiting { work: Vec::new(), bytes: 0 }) };
}

struct Waiting {
    work: Vec<Box<dyn FnOnce()>>,
    bytes: usize,
}

/// While one lives, this thread's work is put off. Locks that are taken after it must be released before it is dropped.
/// It belongs to the thread.
pub struct Holding(std::marker::PhantomData<*const ()>);

/// The fate of work that was handed in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The work has run, or will when the outermost [`Holding`] ends.
    Taken,
    /// The work will never run: there is no room for it.
    NoRoom,
}

pub fn hold() -> Holding {
    let _ = DEPTH.try_with(|depth| depth.set(depth.get() + 1));
    Holding(std::marker::PhantomData)
}

pub fn is_holding() -> bool {
    DEPTH.try_with(Cell::get).unwrap_or(0) > 0
}

/// Does `work`, which keeps some `bytes` of memory, now or when this thread holds nothing any more. For none there is
/// always room.
pub fn run(bytes: usize, work: impl FnOnce() + 'static) -> Outcome {
    if !is_holding() {
        work();
        return Outcome::Taken;
    }
    let keep = |waiting: &RefCell<Waiting>| {
        let mut waiting = waiting.borrow_mut();
        let all = waiting.bytes + bytes + size_of::<Box<dyn FnOnce()>>();
        if bytes > 0 && all > MOST_BYTES {
            return Outcome::NoRoom;
        }
        waiting.bytes = all;
        waiting.work.push(Box::new(work));
        Outcome::Taken
    };
    // A thread that is ending keeps nothing.
    WAITING.try_with(keep).unwrap_or(Outcome::NoRoom)
}

impl Drop for Holding {
    fn drop(&mut self) {
        let left = DEPTH.try_with(|depth| {
            depth.set(depth.get().saturating_sub(1));
            depth.get()
        });
        if left != Ok(0) {
            return;
        }
        let waiting = WAITING.try_with(|waiting| {
            let mut waiting = waiting.borrow_mut();
            waiting.bytes = 0;
            std::mem::take(&mut waiting.work)
        });
        for work in waiting.into_iter().flatten() {
            work();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::rc::Rc;

    #[test]
    fn work_waits_for_the_outermost_and_keeps_its_order() {
        let done = Rc::new(RefCell::new(Vec::new()));
        let add = |number: u32| {
            let done = done.clone();
            run(0, move || done.borrow_mut().push(number))
        };
        add(1);
        let outer = hold();
        add(2);
        let inner = hold();
        add(3);
        drop(inner);
        assert!(is_holding());
        assert_eq!(*done.borrow(), [1]);
        drop(outer);
        assert_eq!(*done.borrow(), [1, 2, 3]);
        add(4);
        assert_eq!(*done.borrow(), [1, 2, 3, 4]);
    }

    #[test]
    fn what_waits_is_bounded_and_there_is_room_again_afterwards() {
        let ran = Rc::new(Cell::new(0));
        for _ in 0..2 {
            let _holding = hold();
            let outcomes = (0..MOST_BYTES >> 20).map(|_| {
                let ran = ran.clone();
                run(1 << 20, move || ran.set(ran.get() + 1))
            });
            let outcomes = outcomes.collect::<Vec<_>>();
            let (last, others) = outcomes.split_last().unwrap();
            assert!(others.iter().all(|outcome| *outcome == Outcome::Taken));
            assert_eq!(*last, Outcome::NoRoom);
        }
        assert_eq!(ran.get(), 2 * ((MOST_BYTES >> 20) - 1));
    }

    #[test]
    fn work_is_done_when_a_panic_unwinds() {
        let ran = Rc::new(Cell::new(false));
        let of_work = ran.clone();
        let unwound = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            let _holding = hold();
            run(0, move || of_work.set(true));
            panic!("the test's own");
        }));
        assert!(unwound.is_err() && ran.get() && !is_holding());
    }
}
