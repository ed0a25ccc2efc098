"""What the house keeps of who has an account, who sees it, for how long: told before one makes one."""

from __future__ import annotations

from html import escape

from hall_app.house.people.records import CODE_DAYS, OFFICE_HOURS, VISITOR_DAYS
from hall_app.web.pages.frame import part
from hall_app.web.platform.counter import Asking, Page, Shown

__all__ = ["privacy_page"]

# key: heading and lines in zh, and in en. A line is a sentence of fact; figures come from where they are set.
_PARTS: tuple[tuple[str, tuple[str, tuple[str, ...]], tuple[str, tuple[str, ...]]], ...] = (
    (
        "kept",
        (
            "保存什么",
            (
                "邮箱、您自填的称呼、所用语言；密码只存 argon2id 散列值，开启两步验证时存其密钥。",
                "登录会话的起止时间；不记录浏览器，也不记录网络地址。",
                "您的收藏与预约（人数、团体名称）；参观记录只在您开启后保存，且只记日期。",
                "问卷的撤回码：只在您要求时由账户保管；它把账户与那份回答连在一起。",
                "操作记录：何时做了何事，只以随机编号指代人，不含邮箱，也不含您看过什么。",
            ),
        ),
        (
            "What is kept",
            (
                "Your address, the name you choose to give, your language; of the password an argon2id hash alone, and "
                "the secret of your authenticator where you set one up.",
                "When a session began and until when it lasts; nothing of your browser, nothing of your network "
                "address.",
                "Favourites, and reservations with their number of people and the name of a group; visits only where "
                "you turn that on, and by the day.",
                "The withdrawal code of answers only where you ask that the account keep it; it links the account to "
                "those answers.",
                "A journal of what was done and when, in which a random number stands for you and never your address. "
                "What you looked at is not in it.",
            ),
        ),
    ),
    (
        "seen",
        (
            "谁能看到",
            (
                "管理员：邮箱、称呼、角色与操作记录；策展人：预约者的称呼（未填时为邮箱）、团体与人数。",
                "收藏与参观记录只有您自己看得到。资料不交给任何人，页面不含第三方内容，不做统计跟踪。",
                "问卷答卷与账户分开存放；除您让账户保管的撤回码之外，两者之间没有关联。撤回码不在办公室的任何页面上，"
                "但能读取数据库的人看得到。",
            ),
        ),
        (
            "Who sees it",
            (
                "Administrators: addresses, names, roles and the journal. Curators: the name of who booked (the "
                "address where none is given), group and number.",
                "Favourites and visits are seen by you alone. Nothing is handed on; pages hold nothing of third "
                "parties and follow nobody.",
                "Answers to questionnaires lie apart from accounts, and nothing leads from one to the other but the "
                "codes that you asked to have kept. No page of the office shows these; who can read the database can.",
            ),
        ),
    ),
    (
        "until",
        (
            "保存多久",
            (
                "直到您删除账户：邮箱、称呼、密码、收藏、参观记录、撤回码与预约当即删除，预约的名额让给候补者；"
                "操作记录留下的编号不再指向任何人。问卷的回答留下，不再与您相连；要删除，请先撤回。",
                "登录会话 {days} 天，办公室会话 {hours} 小时，一次性代码 {codes} 天。",
                "删除之前所做的备份由本馆另行保管与销毁。",
            ),
        ),
        (
            "For how long",
            (
                "Until you delete the account: address, name, password, favourites, visits, kept "
                "withdrawal codes and reservations go at once, your places to who waits; the number left in the "
                "journal leads to nobody. Answers to questionnaires stay and are nobody's: withdraw first what "
                "should go.",
                "Sessions last {days} days, those of the office {hours} hours, one-time codes {codes} days.",
                "Backups made before are kept and destroyed by the house.",
            ),
        ),
    ),
    (
        "cookies",
        (
            "Cookie 与浏览器存储",
            (
                "hall-me（登录后）、hall-office（工作人员登录后）、hall-form（打开表单时，确认表单来自您的浏览器）、"
                "hall-place（在展厅内，关闭浏览器即失效）、hall-known（登录后留下，至多 400 天：他人猜您的密码时，"
                "您的浏览器仍可登录；其中没有您的信息，也不能代替密码，密码更改即失效）。脚本读不到它们，别无其他。",
                "展厅的设置与位置、问卷草稿只留在您的浏览器里；撤回码也是，除非您让账户保管。",
            ),
        ),
        (
            "Cookies, and what your browser keeps",
            (
                "hall-me once you sign in, hall-office for staff, hall-form where there is a form, which ties it "
                "to your browser, hall-place in the hall, until the browser is closed, and hall-known, which signing "
                "in leaves for 400 days at most: while others guess at your password this browser still gets in. It "
                "says nothing of you, is no way in without the password, and is void once that is changed. No script "
                "reads them, and there are no others.",
                "Settings of the hall, where you stood and drafts of answers stay in your browser, and so do "
                "withdrawal codes unless you ask the account to keep one.",
            ),
        ),
    ),
)


def privacy_page(asking: Asking) -> Shown:
    word = asking.word
    figures = {"days": VISITOR_DAYS, "hours": OFFICE_HOURS, "codes": CODE_DAYS}
    told = ""
    for key, zh, en in _PARTS:
        heading, lines = zh if asking.lang == "zh" else en
        told += part(
            key, heading, "<ul>" + "".join(f"<li>{line.format(**figures)}</li>" for line in lines) + "</ul>"
        )
    title = word("账户与隐私", "Accounts and privacy")
    lead = word(
        "参观、阅读与问卷都不需要账户。有账户的人，本馆保存以下资料。",
        "To visit, to read and to answer takes no account. Of who has one, this is kept.",
    )
    ways = (
        (asking.address("/me"), word("导出或删除我的资料", "Take a copy of my data, or delete it")),
        (asking.address("/privacy"), word("答卷的隐私说明", "Privacy of answers to questionnaires")),
    )
    listed = "".join(f'<a href="{escape(to)}">{name}</a>' for to, name in ways)
    main = f"""<header><h1>{title}</h1><p class="lead">{lead}</p></header>
<div class="text">{told}</div><p class="doors">{listed}</p>"""
    return Shown(Page(title, main, "me"), path="/me/privacy")
