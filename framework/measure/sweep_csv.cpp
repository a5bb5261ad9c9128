// results.csv.
#include "graph/value_text.h"
#include "measure/sweep_results.h"
#include <algorithm>
#include <set>

namespace kestrel {
namespace {

std::string csvField(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

std::string csvNumber(const std::optional<double>& value) {
    return value ? numberText(*value) : std::string();
}

// The names that columns are made of, over all rows.
struct CsvColumns {
    std::set<std::string> times, axes, reports;
};

CsvColumns csvColumns(const SweepResults& results) {
    CsvColumns columns;
    for (const SweepRow& row : results.rows) {
        for (const auto& [name, label] : row.axes) columns.axes.insert(name);
        for (const auto& [name, time] : row.ms) columns.times.insert(name);
        for (const auto& [name, value] : row.picture.reports) columns.reports.insert(name);
    }
    return columns;
}

std::vector<std::string> csvHeader(const CsvColumns& columns) {
    std::vector<std::string> header{"scene", "camera", "variant", "kind", "series", "plot"};
    for (const std::string& axis : columns.axes) header.push_back("axis " + axis);
    header.insert(header.end(), {"machine", "repeat_count"});
    for (const std::string& time : columns.times)
        for (const char* which : {"", " q1", " q3"}) header.push_back("ms " + time + which);
    header.insert(header.end(), {"memory_transient",
                                 "memory_persistent",
                                 "compile_ms",
                                 "set_up_ms",
                                 "left_out_count",
                                 "mse",
                                 "psnr",
                                 "ssim",
                                 "flip",
                                 "reference_noise",
                                 "rays",
                                 "hit_share",
                                 "agreement",
                                 "distance_error",
                                 "split mse",
                                 "split representation",
                                 "split algorithm",
                                 "split cross",
                                 "split sampling",
                                 "split reference_noise"});
    for (const std::string& report : columns.reports) header.push_back("report " + report);
    header.insert(header.end(), {"pareto", "failed", "command"});
    return header;
}

std::vector<std::string> csvFields(const SweepRow& row, const CsvColumns& columns) {
    const SweepPicture& picture = row.picture;
    std::vector<std::string> fields{row.scene,  row.camera, row.point, row.ray ? "rays" : "picture",
                                    row.series, row.plot};
    for (const std::string& axis : columns.axes) {
        const auto found = std::ranges::find(row.axes, axis, &std::pair<std::string, std::string>::first);
        fields.push_back(found == row.axes.end() ? "" : found->second);
    }
    fields.insert(fields.end(), {row.machine, std::to_string(row.repeats)});
    for (const std::string& time : columns.times) {
        const auto found = row.ms.find(time);
        const bool known = found != row.ms.end();
        for (double Quartiles::*which : {&Quartiles::median, &Quartiles::q1, &Quartiles::q3})
            fields.push_back(known ? numberText(found->second.*which) : "");
    }
    const auto error = [&](double SweepErrors::*which) {
        return picture.errors ? numberText((*picture.errors).*which) : std::string();
    };
    const auto ray = [&](double SweepRayFigures::*which) {
        return picture.rays ? numberText((*picture.rays).*which) : std::string();
    };
    fields.insert(fields.end(),
                  {std::to_string(picture.transient), std::to_string(picture.persistent),
                   numberText(picture.compileMs), numberText(picture.setUpMs),
                   std::to_string(picture.leftOut.size()), error(&SweepErrors::mse),
                   csvNumber(picture.errors ? picture.errors->psnr : std::nullopt), error(&SweepErrors::ssim),
                   error(&SweepErrors::flip), csvNumber(row.referenceNoise), ray(&SweepRayFigures::rays),
                   ray(&SweepRayFigures::hitShare), ray(&SweepRayFigures::agreement),
                   csvNumber(picture.rays ? picture.rays->distanceError : std::nullopt)});
    for (double ErrorSplit::*part : {&ErrorSplit::mse, &ErrorSplit::representation, &ErrorSplit::algorithm,
                                     &ErrorSplit::cross, &ErrorSplit::sampling, &ErrorSplit::referenceNoise})
        fields.push_back(picture.split ? numberText((*picture.split).*part) : "");
    for (const std::string& report : columns.reports) {
        const auto found = picture.reports.find(report);
        fields.push_back(found == picture.reports.end() ? "" : numberText(found->second));
    }
    fields.insert(fields.end(), {row.pareto ? "yes" : "no", picture.failed, row.command});
    return fields;
}

std::string csvLine(const std::vector<std::string>& fields) {
    std::string line;
    for (const std::string& field : fields) line += (line.empty() ? "" : ",") + csvField(field);
    return line + "\r\n";
}

} // namespace

std::string resultsCsv(const Sweep&, const SweepResults& results) {
    const CsvColumns columns = csvColumns(results);
    std::string text = csvLine(csvHeader(columns));
    for (const SweepRow& row : results.rows) text += csvLine(csvFields(row, columns));
    return text;
}

} // namespace kestrel
