// SPDX-License-Identifier: MIT OR Apache-2.0
//! Takes the place of `parallel` in pages, which have one thread: iterators under rayon's names do one thing after the
//! other. Rayon itself would run there as well, and be a twentieth of the module.

#![allow(dead_code, reason = "some of it only the C API uses, which a page has not")]

/// Rayon's pool, which is never made: a page has one thread.
pub enum ThreadPool {}

impl ThreadPool {
    pub fn install<T>(&self, _: impl FnOnce() -> T) -> T {
        match *self {}
    }

    pub fn broadcast<T>(&self, _: impl Fn(()) -> T) -> Vec<T> {
        match *self {}
    }
}

/// Builds no pool.
pub struct ThreadPoolBuilder;

impl ThreadPoolBuilder {
    pub fn new() -> Self {
        Self
    }

    pub fn num_threads(self, _: usize) -> Self {
        self
    }

    pub fn thread_name(self, _: impl FnMut(usize) -> String) -> Self {
        self
    }

    pub fn start_handler(self, _: impl Fn(usize)) -> Self {
        self
    }

    /// Errors: always.
    pub fn build(self) -> Result<ThreadPool, &'static str> {
        Err("a page has one thread")
    }
}

/// Does both, the first one first.
pub fn join<A, B>(one: impl FnOnce() -> A, other: impl FnOnce() -> B) -> (A, B) {
    (one(), other())
}

pub mod prelude {
    use std::slice::{Chunks, ChunksMut, Iter, IterMut};

    pub trait ParallelSlice<T> {
        fn par_iter(&self) -> Iter<'_, T>;
        fn par_iter_mut(&mut self) -> IterMut<'_, T>;
        fn par_chunks(&self, size: usize) -> Chunks<'_, T>;
        fn par_chunks_mut(&mut self, size: usize) -> ChunksMut<'_, T>;
    }

    impl<T> ParallelSlice<T> for [T] {
        fn par_iter(&self) -> Iter<'_, T> {
            self.iter()
        }

        fn par_iter_mut(&mut self) -> IterMut<'_, T> {
            self.iter_mut()
        }

        fn par_chunks(&self, size: usize) -> Chunks<'_, T> {
            self.chunks(size)
        }

        fn par_chunks_mut(&mut self, size: usize) -> ChunksMut<'_, T> {
            self.chunks_mut(size)
        }
    }

    pub trait IntoParallelIterator: IntoIterator + Sized {
        fn into_par_iter(self) -> Self::IntoIter {
            self.into_iter()
        }
    }

    impl<I: IntoIterator> IntoParallelIterator for I {}

    pub trait IndexedParallelIterator: Iterator + Sized {
        fn with_min_len(self, _: usize) -> Self {
            self
        }

        fn with_max_len(self, _: usize) -> Self {
            self
        }

        fn reduce_with(self, sum: impl Fn(Self::Item, Self::Item) -> Self::Item) -> Option<Self::Item> {
            self.reduce(sum)
        }

        fn collect_into_vec(self, into: &mut Vec<Self::Item>) {
            into.clear();
            into.extend(self);
        }
    }

    impl<I: Iterator> IndexedParallelIterator for I {}
}
