"""Run in an environment with pytexgen: CPU seconds of TexGen's refine on an 8 x 8 satin, the last word printed."""

import time

import pytexgen as tg

weave = tg.CTextileWeave2D(8, 8, 0.3, 0.2, True)
for i in range(8):
    for j in range(8):
        if j != 3 * i % 8:
            weave.SwapPosition(j, i)
weave.SetYarnWidths(0.1)
weave.SetYarnHeights(0.1)
begin = time.process_time()
weave.GetNumYarns()
weave.GetYarn(0).GetSlaveNodes(0)
print(time.process_time() - begin)
