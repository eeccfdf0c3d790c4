//! Files in and out, on readers and writers, never on paths.
