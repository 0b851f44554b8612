//! Quaternion-based trajectory tracking for small quadcopters.
#![no_std]
