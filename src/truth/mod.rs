//! The visible fraction on the CPU.
