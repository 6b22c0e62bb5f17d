//! Tests of tracing and carrying. They are one program, because a program of its own for each file would take longer to link.

mod carry;
mod characters;
mod common;
mod hostile;
mod identity;
mod joints;
mod solid;
mod trace;
