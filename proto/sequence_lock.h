// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>

/// Implements the sequence lock of a slot. Writer and reader may copy at the same time. Every word is atomic: such a
/// reader gets old and new words mixed, which the lock shows; there is no undefined behaviour.
///
/// Order: the writer's words must not become visible before its odd lock. The reader must read its words before it
/// reads the lock again. Fences order this at no cost per word. The thread sanitizer does not support fences: under it
/// each word is a release store and an acquire load.
namespace disparityd::proto {

#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define DISPARITYD_ORDER_PER_WORD 1
#endif
#endif
#if defined(__SANITIZE_THREAD__)
#define DISPARITYD_ORDER_PER_WORD 1
#endif

#if defined(DISPARITYD_ORDER_PER_WORD)
inline constexpr std::memory_order word_store_order = std::memory_order_release;
inline constexpr std::memory_order word_load_order = std::memory_order_acquire;
inline void words_after_lock() {}
inline void words_before_check() {}
#undef DISPARITYD_ORDER_PER_WORD
#else
inline constexpr std::memory_order word_store_order = std::memory_order_relaxed;
inline constexpr std::memory_order word_load_order = std::memory_order_relaxed;
inline void words_after_lock() {
    std::atomic_thread_fence(std::memory_order_release);
}
inline void words_before_check() {
    std::atomic_thread_fence(std::memory_order_acquire);
}
#endif

/// Keeps the lock odd while the one writer copies: from construction to destruction.
class WriteGuard {
public:
    explicit WriteGuard(std::atomic<std::uint64_t>& lock)
        : lock_(lock), even_((lock.load(std::memory_order_relaxed) + 1) & ~std::uint64_t{1}) {
        lock_.store(even_ + 1, std::memory_order_relaxed);
        words_after_lock();
    }
    ~WriteGuard() { lock_.store(even_ + 2, std::memory_order_release); }
    WriteGuard(const WriteGuard&) = delete;
    WriteGuard& operator=(const WriteGuard&) = delete;

private:
    std::atomic<std::uint64_t>& lock_;
    std::uint64_t even_;
};

/// Checks a reader's copy: what was copied between construction and unchanged() is whole if unchanged() is true. There
/// may be any number of readers.
class ReadCheck {
public:
    explicit ReadCheck(const std::atomic<std::uint64_t>& lock)
        : lock_(&lock), before_(lock.load(std::memory_order_acquire)) {}
    bool writer_inside() const { return (before_ & 1) != 0; }
    bool unchanged() const {
        words_before_check();
        return !writer_inside() && lock_->load(std::memory_order_relaxed) == before_;
    }

private:
    const std::atomic<std::uint64_t>* lock_;
    std::uint64_t before_;
};

inline void store_word(std::uint64_t* to, std::uint64_t value) {
    std::atomic_ref<std::uint64_t>(*to).store(value, word_store_order);
}

inline std::uint64_t load_word(const std::uint64_t* from) {
    // atomic_ref takes no const object in C++20. A load of a lock-free word writes nothing.
    return std::atomic_ref<std::uint64_t>(*const_cast<std::uint64_t*>(from)).load(word_load_order);
}

/// Copies `bytes` bytes out of shared words; `from` lies at a multiple of 8 and is readable up to the next one.
inline void copy_from_shared(void* to, const std::uint64_t* from, std::size_t bytes) {
    auto* out = static_cast<std::uint8_t*>(to);
    const std::size_t words = bytes / 8;
    for (std::size_t i = 0; i < words; ++i) {
        const std::uint64_t word = load_word(from + i);
        std::memcpy(out + 8 * i, &word, 8);
    }
    if (bytes % 8 != 0) {
        const std::uint64_t word = load_word(from + words);
        std::memcpy(out + 8 * words, &word, bytes % 8);
    }
}

/// Packs rows one after the other into shared words, whatever their length; flush() stores the last, partial word.
class SharedPacker {
public:
    explicit SharedPacker(std::uint64_t* to) : to_(to) {}

    void append(const void* data, std::size_t bytes) {
        const auto* in = static_cast<const std::uint8_t*>(data);
        if (filled_ != 0) {
            const std::size_t part = bytes < 8 - filled_ ? bytes : 8 - filled_;
            std::memcpy(partial_ + filled_, in, part);
            filled_ += part;
            in += part;
            bytes -= part;
            if (filled_ < 8) {
                return;
            }
            flush();
        }
        const std::size_t words = bytes / 8;
        for (std::size_t i = 0; i < words; ++i) {
            std::uint64_t word = 0;
            std::memcpy(&word, in + 8 * i, 8);
            store_word(to_ + i, word);
        }
        to_ += words;
        filled_ = bytes % 8;
        std::memcpy(partial_, in + 8 * words, filled_);
    }

    void flush() {
        if (filled_ == 0) {
            return;
        }
        std::memset(partial_ + filled_, 0, 8 - filled_);
        std::uint64_t word = 0;
        std::memcpy(&word, partial_, 8);
        store_word(to_++, word);
        filled_ = 0;
    }

private:
    std::uint64_t* to_;
    std::uint8_t partial_[8] = {};
    std::size_t filled_ = 0;
};

}  // namespace disparityd::proto
