// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace disparityd::pipeline {

/// Items in the order in which they came, linked through their own member `following`. The list owns no item and
/// allocates nothing.
template <typename T>
class FifoList {
public:
    T* first() const { return first_; }

    void append(T& item) {
        item.following = nullptr;
        T** link = &first_;
        while (*link != nullptr) {
            link = &(*link)->following;
        }
        *link = &item;
    }

    /// Takes `item`, which is in the list, out of it.
    void remove(T& item) {
        T** link = &first_;
        while (*link != &item) {
            link = &(*link)->following;
        }
        *link = item.following;
    }

    int length() const {
        int count = 0;
        for (const T* item = first_; item != nullptr; item = item->following) {
            ++count;
        }
        return count;
    }

private:
    T* first_ = nullptr;
};

}  // namespace disparityd::pipeline
