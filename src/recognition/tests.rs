//! What a recognition answers on simulated patches.
