// kestrel._kestrel: what the Python package calls.
#include "bindings.h"
#include "core/log.h"
#include "core/version.h"
#include "gpu.h"

PYBIND11_MODULE(_kestrel, module) {
    using namespace kestrel::python;
    kestrel::setLogLevel(kestrel::LogLevel::Warning);
    module.attr("version") = kestrel::version();
    module.attr("parts") = kestrel::parts();
    bindErrors(module);
    bindGraph(module);
    bindMetrics(module);
    bindRenderer(module);
    bindSweeps(module);
    py::module_::import("atexit").attr("register")(py::cpp_function(&Gpu::stop));
}
