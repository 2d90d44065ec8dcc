// SPDX-License-Identifier: BSD-3-Clause
// How the outputs of the filters look at first: the defaults of the representations of
// xml/Representations.xml, and colour maps by the name of an array, with names for its values where
// they are kinds and not amounts.
#pragma once

/// Adds them to ParaView's settings, below those of the user. Called when the plugin is loaded.
void PalpateAddLooks();
