// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/cuda/stream.h"

namespace disparityd::cuda {

/// The operations of a frame, handed to the driver once and started anew by one call for each frame, instead of one by
/// one. Addresses and arguments stay as they were.
class Graph {
public:
    Graph() = default;
    ~Graph();
    Graph(const Graph&) = delete;
    Graph& operator=(const Graph&) = delete;

    /// Captures what enqueue() enqueues on the stream, in the place of what it held; none of it runs yet. Lets through
    /// what enqueue() throws. Holds nothing afterwards where the driver refuses.
    template <typename Enqueue>
    void capture(const Stream& stream, Enqueue enqueue) {
        clear();
        if (!begin(stream)) {
            return;
        }
        try {
            enqueue();
        } catch (...) {
            end(stream);
            clear();
            throw;
        }
        end(stream);
    }
    void clear();
    bool holds_operations() const { return executable_ != nullptr; }

    /// Only when it holds operations.
    void start(const Stream& stream) const;

private:
    static bool begin(const Stream& stream);
    void end(const Stream& stream);

    cudaGraphExec_t executable_ = nullptr;
};

}  // namespace disparityd::cuda
