#include <isobath/base/file_access.hpp>
#include <isobath/run/run_outputs.hpp>

namespace isobath {

void check_run_outputs(const RunRequest& request, const std::vector<std::string>& priors) {
  const Configuration& configuration = request.configuration;
  std::vector<std::filesystem::path> inputs{request.mission,
                                            configuration.input.navigation,
                                            configuration.input.reference,
                                            configuration.sensor.model,
                                            configuration.sensor.histogram,
                                            configuration.sensor.histogram_vertical};
  inputs.insert(inputs.end(), priors.begin(), priors.end());
  // From a folder the program reads logs alone. No file of a run is a log, so that they may stand in the same folder.
  std::error_code ignored;
  if (!std::filesystem::is_directory(request.input, ignored)) inputs.push_back(request.input);
  for (const char* name : kRunFiles) check_output_is_no_input(request.out / name, inputs, "--out");
  if (request.record.empty()) return;
  const auto logs = files_of_input(request.input);
  inputs.insert(inputs.end(), logs.begin(), logs.end());
  check_output_is_no_input(request.record, inputs, "--record");
}

}  // namespace isobath
