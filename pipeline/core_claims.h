// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace disparityd::pipeline {

/// Says which cores the threads of a pool may be pinned to. Of all pools on the computer, those of other processes
/// included, one has a core at a time: two that pinned a thread each to the same core would wait for each other while
/// others are free. How the processes agree is the matter of who implements it. One thread at a time.
class CoreClaims {
public:
    virtual ~CoreClaims() = default;

    /// Tries to have the core, by the system's number, for this object alone. Returns whether it is so now: also for
    /// one that it had already. False where another one has it, even one that had been this object's.
    virtual bool claim(int core) = 0;

    /// Lets others have all cores of this object, and counts for nothing among them until the next claim().
    virtual void leave() = 0;

    /// Returns a line for people: why the last claim() that returned false did so.
    virtual std::string refusal() const = 0;
};

}  // namespace disparityd::pipeline
