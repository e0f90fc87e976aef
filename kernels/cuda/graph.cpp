// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/graph.h"

#include "kernels/cuda/device.h"

namespace disparityd::cuda {

Graph::~Graph() {
    clear();
}

void Graph::clear() {
    if (executable_ != nullptr) {
        static_cast<void>(cudaGraphExecDestroy(executable_));
        executable_ = nullptr;
    }
}

bool Graph::begin(const Stream& stream) {
    // Of this thread: the other stage's goes on with what it does.
    const bool begun = cudaStreamBeginCapture(stream.get(), cudaStreamCaptureModeThreadLocal) == cudaSuccess;
    static_cast<void>(cudaGetLastError());  // a refusal is no error of the operations
    return begun;
}

void Graph::end(const Stream& stream) {
    cudaGraph_t graph = nullptr;
    if (cudaStreamEndCapture(stream.get(), &graph) == cudaSuccess &&
        cudaGraphInstantiateWithFlags(&executable_, graph, 0) != cudaSuccess) {
        executable_ = nullptr;
    }
    if (graph != nullptr) {
        static_cast<void>(cudaGraphDestroy(graph));
    }
    static_cast<void>(cudaGetLastError());
}

void Graph::start(const Stream& stream) const {
    check(cudaGraphLaunch(executable_, stream.get()), "starting a frame");
}

}  // namespace disparityd::cuda
