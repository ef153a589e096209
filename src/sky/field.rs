// SPDX-License-Identifier: MIT OR Apache-2.0
//! The stars that a sky shows, and their index: one for the whole process, made when it is first asked for and shared
//! while anybody holds it.

use super::catalogue;
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

impl StarField {
    /// The field's index. The catalogue's takes milliseconds and stays; others take about a second unless somebody
    /// holds them. Errors: OUT_OF_MEMORY.
    pub fn index(self) -> Result<Arc<StarIndex>> {
        if self == Self::Catalogue {
            return Self::catalogue();
        }
        // The lock is held while the index is made: a thread that asks for the same one meanwhile is to wait for it.
        let mut made = MADE.lock();
        if let Some(index) = find(&made, self) {
            return Ok(index);
        }
        made.retain(|(_, index)| index.strong_count() > 0);
        allocate::check_room(ROOM, "making a sky of random stars")?;
        let index = Arc::new(self.make()?);
        made.push((self, Arc::downgrade(&index)));
        Ok(index)
    }

    fn make(self) -> Result<StarIndex> {
        match self {
            Self::Catalogue => StarIndex::new(catalogue::stars()),
            Self::Procedural(seed) => StarIndex::new(procedural::stars(seed)?),
            Self::Continued(seed) => {
                let fainter = procedural::stars(seed)?.filter(|star| star.magnitude > catalogue::FAINTEST);
                StarIndex::new(catalogue::stars().chain(fainter))
            }
        }
    }

    /// The field's index if it is there already; the catalogue's always is. Errors: OUT_OF_MEMORY.
    pub fn index_if_made(self) -> Result<Option<Arc<StarIndex>>> {
        if self == Self::Catalogue { Self::catalogue().map(Some) } else { Ok(find(&MADE.lock(), self)) }
    }

    /// Errors: OUT_OF_MEMORY.
    pub fn catalogue() -> Result<Arc<StarIndex>> {
        static SHARED: Mutex<Option<Arc<StarIndex>>> = Mutex::new(None);
        let mut shared = SHARED.lock();
        match &*shared {
            Some(index) => Ok(index.clone()),
            None => Ok(shared.insert(Arc::new(Self::Catalogue.make()?)).clone()),
        }
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
        let if_made = || field.index_if_made().expect("no catalogue is asked for");
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
