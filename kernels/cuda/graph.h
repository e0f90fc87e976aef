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

    /// Holds what put_on_stream() puts on the stream instead of what it held before; none of it runs yet. What that
    /// throws goes through. Holds nothing afterwards where the driver refuses.
    template <typename PutOnStream>
    void take(const Stream& stream, PutOnStream put_on_stream) {
        clear();
        if (!begin(stream)) {
            return;
        }
        try {
            put_on_stream();
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
