//! What the test suites and the development commands share: the sample cartoon and golden pictures.
