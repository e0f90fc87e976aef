// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <type_traits>
#include <utility>

namespace disparityd {

/// A callable passed by reference, without allocation; it must outlive the call that takes it.
template <typename Signature>
class FunctionRef;

template <typename Result, typename... Args>
class FunctionRef<Result(Args...)> {
public:
    template <typename Callable>
    requires(!std::is_same_v<std::remove_cvref_t<Callable>, FunctionRef>)
        FunctionRef(Callable&& callable)  // NOLINT: a reference wrapper converts from what it refers to
        : object_(const_cast<void*>(static_cast<const void*>(std::addressof(callable)))),
          call_([](void* object, Args... args) -> Result {
              return (*static_cast<std::remove_reference_t<Callable>*>(object))(std::forward<Args>(args)...);
          }) {}

    Result operator()(Args... args) const { return call_(object_, std::forward<Args>(args)...); }

private:
    void* object_;
    Result (*call_)(void*, Args...);
};

/// Workers lent to a kernel for the length of a call. Kernels own no threads: they say what may run side by side.
class Parallel {
public:
    virtual ~Parallel() = default;

    /// How many tasks can run at the same time, the caller's thread included; at least 1.
    virtual int workers() const = 0;

    /// Runs task(0) .. task(count - 1), in any order and on any worker, and returns when all have ended.
    /// Tasks must not throw, and must not call for_each themselves. A worker ends a task before it begins another one,
    /// so that a task may wait for one that has begun before it. Threads need 256 KiB of stack for a task.
    virtual void for_each(int count, FunctionRef<void(int)> task) = 0;
};

/// Everything in the caller's thread, in order.
class Serial final : public Parallel {
public:
    int workers() const override { return 1; }
    void for_each(int count, FunctionRef<void(int)> task) override {
        for (int i = 0; i < count; ++i) {
            task(i);
        }
    }
};

}  // namespace disparityd
