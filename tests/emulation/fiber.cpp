// SPDX-License-Identifier: Apache-2.0
#include "tests/emulation/fiber.h"

#ifdef SIMT_ADDRESS_SANITIZER
#include <sanitizer/common_interface_defs.h>
#endif

namespace disparityd::simt {

namespace {

constexpr std::size_t stack_bytes = std::size_t{256} << 10;

}  // namespace

Fiber::Fiber(std::function<void()> body) : body_(std::move(body)), allocator_(stack_bytes) {
    stack_ = allocator_.allocate();
    fiber_ = boost::context::fiber(std::allocator_arg, boost::context::preallocated(stack_.sp, stack_.size, stack_),
                                   allocator_, [this](boost::context::fiber&& host) { return run(std::move(host)); });
}

Fiber::~Fiber() = default;

void Fiber::enter() {
    announce_switch_to_fiber();
    fiber_ = std::move(fiber_).resume();
    announce_arrival_on_host();
}

void Fiber::leave() {
    announce_switch_to_host();
    host_ = std::move(host_).resume();
    announce_arrival_on_fiber();
}

boost::context::fiber Fiber::run(boost::context::fiber&& host) {
    announce_arrival_on_fiber();
    host_ = std::move(host);
    body_();
    announce_switch_to_host();
    return std::move(host_);
}

void Fiber::announce_switch_to_fiber() {
#ifdef SIMT_ADDRESS_SANITIZER
    __sanitizer_start_switch_fiber(&host_fake_stack_, static_cast<std::byte*>(stack_.sp) - stack_.size, stack_.size);
#endif
}

void Fiber::announce_arrival_on_host() {
#ifdef SIMT_ADDRESS_SANITIZER
    __sanitizer_finish_switch_fiber(host_fake_stack_, nullptr, nullptr);
#endif
}

void Fiber::announce_switch_to_host() {
#ifdef SIMT_ADDRESS_SANITIZER
    __sanitizer_start_switch_fiber(&fiber_fake_stack_, host_stack_, host_stack_size_);
#endif
}

void Fiber::announce_arrival_on_fiber() {
#ifdef SIMT_ADDRESS_SANITIZER
    __sanitizer_finish_switch_fiber(fiber_fake_stack_, &host_stack_, &host_stack_size_);
#endif
}

}  // namespace disparityd::simt
