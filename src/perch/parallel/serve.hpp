#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "perch/parallel/batch.hpp"
#include "perch/parallel/executor.hpp"
#include "perch/parallel/transport.hpp"

namespace perch {

/// By topic.
using Services = std::map<std::string, std::shared_ptr<Service>>;

/// Gives an executor of so many threads; 0 = as many as this process should have.
using MakeExecutor = std::function<std::unique_ptr<Executor>(std::size_t threads)>;

/// What every process but the first does until the first says that no more is to come: works on portions of
/// batches, by its services. What goes wrong is reported to the first and ends nothing here. \param program
/// which one this is, with its version: the first wants to be the same.
void serve(Transport& transport, const Services& services, const MakeExecutor& make_executor,
           const std::string& program);

/// Says to all other processes that no more is to come.
void dismiss(Transport& transport);

}  // namespace perch
