// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <utility>

#include <boost/context/fiber.hpp>
#include <boost/context/protected_fixedsize_stack.hpp>

namespace disparityd::simt {

/// A body with a stack of its own that is entered and left any number of times, always by the same host thread. The
/// address and thread sanitizers are told about every switch.
class Fiber {
public:
    explicit Fiber(std::function<void()> body);
    ~Fiber();  ///< the body must have returned, or never have been entered
    Fiber(const Fiber&) = delete;
    Fiber& operator=(const Fiber&) = delete;

    /// From the host thread's stack: runs the body until it leaves or returns.
    void enter();
    /// From within the body: goes on where enter() was called.
    void leave();

private:
    boost::context::fiber run(boost::context::fiber&& host);
    void announce_switch_to_fiber();
    void announce_arrival_on_host();
    void announce_switch_to_host();
    void announce_arrival_on_fiber();

    std::function<void()> body_;
    boost::context::protected_fixedsize_stack allocator_;
    boost::context::stack_context stack_;
    boost::context::fiber fiber_;
    boost::context::fiber host_;
    // Of the sanitizers.
    [[maybe_unused]] void* host_fake_stack_ = nullptr;
    [[maybe_unused]] void* fiber_fake_stack_ = nullptr;
    [[maybe_unused]] const void* host_stack_ = nullptr;
    [[maybe_unused]] std::size_t host_stack_size_ = 0;
};

}  // namespace disparityd::simt
