#pragma once
namespace tendonlab::bindings {
/// What this build of the core needs and the processor has not, and what to do; null if it has everything.
const char* lacking_instructions();
}  // namespace tendonlab::bindings
