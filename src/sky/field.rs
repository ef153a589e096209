// SPDX-License-Identifier: MIT OR Apache-2.0
//! The stars that a sky shows, and their index: one for the whole process, made when it is first asked for and shared
//! while anybody holds it.

use super::catalogue;
use super::growing_index::GrowingIndex;
use super::index::StarIndex;
use super::procedural;
use crate::allocate;
use crate::error::Result;
use parking_lot::Mutex;
use std::sync::{Arc, Weak};

/// The stars of a sky.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StarField {
    /// The real stars.
    Catalogue,
    /// Random stars of this seed.
    Procedural(u64),
    /// The real stars, and random ones that are fainter.
    Continued(u64),
}

/// Host memory that making a large index takes for a while: stars, lists and what is sorted.
const ROOM: usize = 300 << 20;

/// Large indices that somebody may still hold.
static MADE: Mutex<Vec<(StarField, Weak<StarIndex>)>> = Mutex::new(Vec::new());

/// The catalogue's index, which is kept.
static CATALOGUE: Mutex<Option<Arc<StarIndex>>> = Mutex::new(None);

impl StarField {
    /// The field's index. The catalogue's takes milliseconds and stays; others take about a second unless somebody
    /// holds them. Errors: OUT_OF_MEMORY.
    pub fn index(self) -> Result<Arc<StarIndex>> {
        // The lock is held while the index is made: a thread that asks for the same one meanwhile is to wait for it.
        match self {
            Self::Catalogue => Self::kept(&mut CATALOGUE.lock(), || self.make()),
            _ => self.shared(&mut MADE.lock(), || self.make()),
        }
    }

    /// The index, for those who make it in parts. Errors: OUT_OF_MEMORY.
    pub fn growing(self) -> Result<GrowingIndex> {
        if self != Self::Catalogue {
            allocate::check_room(ROOM, "making a sky of random stars")?;
        }
        match self {
            Self::Catalogue => GrowingIndex::new(catalogue::stars()),
            Self::Procedural(seed) => GrowingIndex::new(procedural::stars(seed)?),
            Self::Continued(seed) => {
                let fainter = procedural::stars(seed)?.filter(|star| star.magnitude > catalogue::FAINTEST);
                GrowingIndex::new(catalogue::stars().chain(fainter))
            }
        }
    }

    fn make(self) -> Result<StarIndex> {
        self.growing()?.grown()
    }

    /// Shares an index that was made in parts, or another one that was made meanwhile. Errors: none of its own.
    pub fn share(self, index: StarIndex) -> Result<Arc<StarIndex>> {
        match self {
            Self::Catalogue => Self::kept(&mut CATALOGUE.lock(), || Ok(index)),
            _ => self.shared(&mut MADE.lock(), || Ok(index)),
        }
    }

    /// The catalogue's index, which `make` makes if it is not there. Errors: those of `make`.
    fn kept(kept: &mut Option<Arc<StarIndex>>, make: impl FnOnce() -> Result<StarIndex>) -> Result<Arc<StarIndex>> {
        match kept {
            Some(index) => Ok(index.clone()),
            None => Ok(kept.insert(Arc::new(make()?)).clone()),
        }
    }

    /// The index of random stars, which `make` makes if nobody holds it. Errors: those of `make`.
    fn shared(
        self,
        made: &mut Vec<(Self, Weak<StarIndex>)>,
        make: impl FnOnce() -> Result<StarIndex>,
    ) -> Result<Arc<StarIndex>> {
        if let Some(index) = find(made, self) {
            return Ok(index);
        }
        made.retain(|(_, index)| index.strong_count() > 0);
        let index = Arc::new(make()?);
        made.push((self, Arc::downgrade(&index)));
        Ok(index)
    }

    /// The field's index if it is there already.
    pub fn index_if_made(self) -> Option<Arc<StarIndex>> {
        match self {
            Self::Catalogue => CATALOGUE.lock().clone(),
            _ => find(&MADE.lock(), self),
        }
    }

    /// Errors: OUT_OF_MEMORY.
    pub fn catalogue() -> Result<Arc<StarIndex>> {
        Self::Catalogue.index()
    }
}

fn find(made: &[(StarField, Weak<StarIndex>)], field: StarField) -> Option<Arc<StarIndex>> {
    made.iter().find(|(key, _)| *key == field).and_then(|(_, index)| index.upgrade())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_index_is_shared_while_it_is_held_and_then_freed() {
        let field = StarField::Procedural(0x5eed);
        let if_made = || field.index_if_made();
        assert!(if_made().is_none());
        let started = std::time::Instant::now();
        let first = field.index().expect("an index");
        eprintln!("made in {:?}", started.elapsed());
        let again = std::thread::spawn(move || field.index().expect("an index")).join().expect("a thread");
        assert!(Arc::ptr_eq(&first, &again));
        assert!(if_made().is_some_and(|index| Arc::ptr_eq(&index, &first)));
        drop((first, again));
        assert!(if_made().is_none());
        assert!(Arc::ptr_eq(
            &StarField::catalogue().expect("an index"),
            &StarField::Catalogue.index().expect("an index")
        ));
    }
}
