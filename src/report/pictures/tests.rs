//! Sizes, well-formedness and colours of the pictures.
