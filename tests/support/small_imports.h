#pragma once

#include <filesystem>

/// What each import reads, as small as it may be; file names have blanks and letters that ASCII lacks.
namespace fathom::test {

/// "Bandaufnahme ä.bag", an INS for 4 s, and its topics, "Themen ö.yaml".
void writeSmallBag(const std::filesystem::path& folder);
/// "Ecken é.csv", a board of 3 x 3 corners seen straight on from 0.5 m, and its camera, "Kamera 1.yaml".
void writeSmallCorners(const std::filesystem::path& folder);
/// "Schachbrett ü.csv", a board of 4 x 3 corners of 0.05 m in eight images of 640 x 480, seen askew.
void writeSmallBoard(const std::filesystem::path& folder);
/// The folder "Tabellen ö", a minute of section 1 of a sea trial: a level turn with a little heave.
void writeSmallSeaTrial(const std::filesystem::path& folder);
/// "Punkte ä.csv", six points in each of three frames, seen by cameras side by side, "Kamera links.yaml" and
/// "Kamera rechts.yaml", each before its window.
void writeSmallTiePoints(const std::filesystem::path& folder);
/// "Film ö.avi", five frames of 320 x 240, and their stamps, "Stempel ü.csv".
void writeSmallVideo(const std::filesystem::path& folder);

}  // namespace fathom::test
