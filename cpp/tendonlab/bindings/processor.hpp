#pragma once
namespace tendonlab::bindings {
/// What this build of the core needs and the processor has not, in words; null if it has everything.
const char* lacking_instructions();
}  // namespace tendonlab::bindings
