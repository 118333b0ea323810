//! What a file says and this reading leaves out, in sentences.

/// The most sentences: who reads them has understood after these, and a file may be wrong in a million places.
const MOST: usize = 32;

/// Sentences, each once.
#[derive(Default)]
pub(super) struct Notes {
    sentences: Vec<String>,
    /// The number of those that are one too many.
    more: usize,
}

impl Notes {
    pub fn tell(&mut self, sentence: String) {
        if self.sentences.contains(&sentence) {
            return;
        }
        if self.sentences.len() < MOST {
            self.sentences.push(sentence);
        } else {
            self.more += 1;
        }
    }

    /// All of them; the last says how many more there would be.
    pub fn sentences(self) -> Vec<String> {
        let Self { mut sentences, more } = self;
        if more > 0 {
            sentences.push(format!("there would be {more} more notes on the file"));
        }
        sentences
    }
}
