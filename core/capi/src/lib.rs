//! C ABI of Rototoon.
